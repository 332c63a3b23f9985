// SPDX-License-Identifier: Apache-2.0
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
    void number(uint16_t value) { digits(value, kNoPoint); }
    void signedNumber(int16_t value) { signedDigits(value, kNoPoint); }
    void longNumber(uint32_t value);
    void signedLongNumber(int32_t value);
    void shortHundredths(int16_t value) { signedDigits(value, 2); }  // 2105 as 21.05
    void hundredths(int32_t value);
    void pair(uint8_t first, uint8_t second);  // 1:2
    void hexByte(uint8_t value);               // without leading zero

    // Begins an event or an answer: @S,t
    void event(char service, char tag);
    // The same with a comma behind it: @S,t,
    void answer(char service, char tag);

    // The same with `kind` in the place of @.
    void head(char kind, char service, char tag);

    // A whole line: ~S,t,NUMBER{TEXT}
    void error(char service, char tag, Error error);

    // Ends the line.
    void end();

    void useChecksum(bool on) { checksumOn_ = on; }
    bool usesChecksum() const { return checksumOn_; }

    // The longest line that is sent in one piece, @#,I,NAME*HH, with its line end.
    static constexpr uint8_t kLongestPiece = 42;

    // True if a line of up to kLongestPiece characters can be written without waiting: ask before sending an
    // event. Not while the line is held.
    bool hasRoom() const { return !held_ && hasRoomForPiece(); }

    // The same for what may be sent while the line is held.
    bool hasRoomForPiece() const __attribute__((noinline));

    // Held for a list (Board::sendList) that is under way, or because the rate is about to change: no line
    // may begin.
    void hold(bool on) { held_ = on; }
    bool isHeld() const { return held_; }

  private:
    static constexpr uint8_t kNoPoint = 255;  // else the digit of five before it, from 0
    void digits(uint16_t value, uint8_t point);
    void signedDigits(int16_t value, uint8_t point);
    void hexDigit(uint8_t value);

    uint8_t checksum_;
    bool checksumOn_;
    bool held_;
};

extern Out out;

}  // namespace asip
