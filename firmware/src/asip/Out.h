// Writes the lines that the board sends. A service uses the global `out`:
//
//   out.event('D', 'e');         // @D,e
//   out.character(',');
//   out.number(42);
//   out.end();                   // newline, with the checksum before it where one was asked for
#pragma once

#include <stdint.h>

#include "Error.h"
#include "Flash.h"

namespace asip {

class Out {
  public:
    void character(char c);
    void text(FlashText text);
    void text(const char* text);
    void number(uint16_t value);
    void signedNumber(int16_t value);
    void hexByte(uint8_t value);  // without leading zero

    // Begins an event or an answer: @S,t
    void event(char service, char tag);

    // A whole line: ~S,t,NUMBER{TEXT}
    void error(char service, char tag, Error error);

    // Ends the line.
    void end();

    void useChecksum(bool on) { checksumOn_ = on; }
    bool usesChecksum() const { return checksumOn_; }

    // True if a line can begin and its first characters be written without waiting: ask before sending an
    // event. Not while a list (Board::sendList) is under way.
    bool hasRoom() const { return !inList_ && hasRoomForElement(); }

    bool hasRoomForElement() const;
    void setInList(bool on) { inList_ = on; }

  private:
    void head(char kind, char service, char tag);
    void hexDigit(uint8_t value);

    uint8_t checksum_;
    bool checksumOn_;
    bool inList_;
};

extern Out out;

}  // namespace asip
