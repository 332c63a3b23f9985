// SPDX-License-Identifier: Apache-2.0
// The board: collects requests, gives each to its service, keeps the auto-events, and answers for the system
// itself (service `#`). There is one, `asip::board`, as there is one line.
#pragma once

#include "Config.h"
#include "IoService.h"

namespace asip {

class Board {
  public:
    // Adds a service, which must outlive the board; before start. One that is there already, and a sixteenth,
    // is not added.
    void add(Service& service);

    // Strict mode: begin() leaves every free pin unallocated and sends no analog events.
    void useStrictMode() { io_.useStrictMode(true); }

    // Opens the line, starts every service and announces the board: `!SKETCH running on CHIP with ...`.
    void begin(FlashText sketch);

    // One pass: at most one request, changes of inputs, auto-events. Call from loop(), always.
    void run();

    // Sends a line of information, `!text`. Waits for the line.
    void info(FlashText text);

    // Takes a free pin for `service`: kInvalidPin if there is no such pin or it is in use.
    Error claimPin(uint8_t pin, const Service& service);

    // True if claimPin() would give the pin to `service`, or has.
    bool canClaim(uint8_t pin, const Service& service) const;
    bool ownsPin(uint8_t pin, const Service& service) const __attribute__((noinline));

    // Gives back every pin of `service` as a free input.
    void releasePins(const Service& service);

    // Sends @S,TAG,COUNT,{...}, each element written by service.reportValue(index), as the line has room: no
    // answer, however long, holds up the board. The next request waits until it is out. Call from
    // processRequest() or reportValues(), or when out.hasRoom().
    void sendList(Service& service, char tag, uint8_t count);

    // Collects requests in `buffer` of `size` bytes, at most 250, from now on: one may be as long as size - 4
    // (its checksum and an end), and #,X says so. For services whose requests need more than 62 characters,
    // from begin(). The largest buffer counts.
    void useLongLines(char* buffer, uint8_t size);

    // From now on, or no longer, requests to `service` wait, and with them all that come behind on the line:
    // for a service that answers a request later and can take no other before. Not for long: the line holds
    // some 60 bytes. Where no service calls this it costs nothing.
    void setBusy(const Service& service, bool busy);

    // The tag of the list under way.
    char listTag() const { return listTag_; }

    IoService& io() { return io_; }

  private:
    friend class FakeBoard;  // for the tests on the host

    static constexpr uint8_t kSpoiled = 255;
    static constexpr uint8_t kExtended = 255;
    static constexpr uint8_t kMaxServices = 15;  // and I: a pin's owner is kept in four bits

    // What the line of the request is kept for: a request that is complete waits for the line to have room,
    // or it goes on after its execution. From kStoreName on it counts the bytes that have been stored.
    enum : uint8_t { kNoJob, kSwitchRate, kStoreName, kExecute = 255 };

    bool nextRequest();
    bool isBusy();
    bool receive();
    static void readAhead();
    bool collect(char c);
    bool beginsAnother(char c);
    void beginNext();
    bool isQuiet();
    bool isExtended() const { return kExtensions && next_ == kExtended; }
    static uint8_t busyBit(char id) { return static_cast<uint8_t>(1 << (id & 7)); }
    inline char* line() __attribute__((always_inline)) { return longLineSize_ == 0 ? line_ : longLine_; }
    static uint8_t maxLength() {
        return longLineSize_ == 0 ? kMaxRequestLength : static_cast<uint8_t>(longLineSize_ - 1);
    }
    void execute(bool executed);
    Error process(uint8_t length);
    Error dispatch(Service& service, Request& request);
    void tick(uint8_t elapsedMs);
    void countWait(uint8_t elapsedMs);
    void reportWhatIsDue();
    void restart();

    Service* find(char id);
    Service* serviceAt(uint8_t number) __attribute__((noinline));
    uint8_t numberOf(const Service& service) const;
    uint8_t countServices() const;

    void startList(Service* service, char id, char tag, uint8_t count);
    void continueList();

    // System.cpp
    Error processSystem(Request& request);
    void sendVersion();
    void writeSystemElement(uint8_t index);

    // Extensions.cpp
    Error processExtension(Request& request);
    void sendExtensions();
    Error echo(Request& request);
    Error identity(Request& request);
    Error lineRate(Request& request);
    Error checksum(Request& request);
    bool acceptChecksum(uint8_t& length);
    void digestLine();
    void continueExtension();
    void storeName();
    void sendName();
    void useExtensions(bool on) __attribute__((noinline));
    void giveUpRate();

    // The buffer of the service with the longest requests. Where there is none these are never written, and
    // compiled as the constants that they are.
    static void (*readAhead_)();
    static char* longLine_;
    static uint8_t longLineSize_;

    // Services that are busy, by the lowest bits of their letters: others that share them wait along. Never
    // written where there is no such service.
    static uint8_t busy_;
    static bool hasBusyServices_;

    IoService io_;
    FlashText sketch_;
    char line_[kMaxRequestLength + 1];
    uint8_t length_;  // collected so far; kSpoiled if it cannot be executed
    uint8_t lastMs_;
    uint8_t job_;
    char listTag_;
    uint8_t listIndex_;
    uint8_t listCount_;
    Service* listService_;  // of the last list; null: the system
    uint16_t digest_;       // of the requests since the last verified fence and their errors
    uint8_t next_;          // the letter that began the next request; kExtended: an extension is in use
    // Left to hear a fence at a new rate, 0 when none is on trial; where no extension is in use, left until
    // what was collected is complete because nothing more came.
    uint16_t waitMs_;
};

extern Board board;

}  // namespace asip
