// SPDX-License-Identifier: Apache-2.0
// Base of everything a board offers. A service is a class with an id, a name, begin() and
// processRequest(); one that reports adds count() and reportValue(). The core finds the service of a
// request, sends its errors, and keeps its auto-event period. docs/service-by-hand.md builds one step by
// step.
#pragma once

#include <stdint.h>

#include "Error.h"
#include "Flash.h"
#include "Out.h"
#include "Request.h"

namespace asip {

class Service {
  public:
    // The letter of the service, 'A' to 'Z'.
    char id() const { return id_; }

    // Its name as listed by #,N: return ASIP_NAME("...").
    virtual FlashText name() const = 0;

    // Claims its pins (board.claimPin) and brings its hardware to rest. Called when the board starts and
    // again at each #,R: all pins are then free inputs and no period is set.
    virtual void begin() = 0;

    // Executes a request, or says what is wrong with it and does nothing.
    virtual Error processRequest(Request& request) = 0;

    // Writes one of its values to `out`, as it stands between the braces of an event.
    virtual void reportValue(uint8_t index);

    // Called when the auto-event period is over, and when the line has room. By default sends the event
    // @S,e,COUNT,{value,...} of count() values at once; a service that has to measure first starts to.
    virtual void reportValues();

    // Called in each pass of the loop. Must be short: a few dozen microseconds.
    virtual void poll();

    // Milliseconds between auto-events, 0 for none.
    __attribute__((noinline)) void setPeriod(uint16_t ms) {
        period_ = remaining_ = ms;
        setDue(false);
    }
    uint16_t period() const { return period_; }

    // How many values it reports.
    uint8_t count() const { return countAndDue_ & (kHoldsText - 1); }

  protected:
    // `count` values are reported, at most 63; a service that reports none has no auto-event request either.
    // kHoldsText is added where its requests hold text: they end at line ends only.
    static constexpr uint8_t kHoldsText = 64;
    constexpr explicit Service(char id, uint8_t count = 0)
        : next_(nullptr), period_(0), remaining_(0), id_(id), countAndDue_(count) {}

    void setCount(uint8_t count) { countAndDue_ = static_cast<uint8_t>((countAndDue_ & kHoldsText) | count); }

  private:
    friend class Board;
    void countDown(uint8_t elapsedMs);

    // A report that finds the line busy stays due. In the top bit of the count: a byte less for each service.
    static constexpr uint8_t kDue = 128;
    bool isDue() const { return countAndDue_ & kDue; }
    void setDue(bool due) {
        countAndDue_ = static_cast<uint8_t>(due ? countAndDue_ | kDue : countAndDue_ & ~kDue);
    }

    Service* next_;
    // Counted down, not compared with a clock: a 16-bit clock misfires when it wraps.
    uint16_t period_;
    uint16_t remaining_;
    char id_;
    uint8_t countAndDue_;
};

}  // namespace asip
