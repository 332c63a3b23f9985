// SPDX-License-Identifier: Apache-2.0
// Any chip on the I2C bus, for programs that know it, beside the services that have a chip there:
//
//   asip::I2cChips chips;
//
// J,s finds the chips: @J,s,2,{60,118}. J,t,118,2,D0 writes D0 to the chip at 118, then, with a repeated
// START, reads two bytes: @J,t,5800. J,t,118,2, only reads, J,t,118,0, only looks whether the chip is there.
//
// A transfer longer than a request is several of one number, from one START to one STOP: J,o,7,60,4000 opens
// it (or begins anew in it, with a repeated START), J,w,7,0000 writes on, J,r,7,16,1 reads sixteen bytes of
// which more follow, J,e,7,0,0000 writes on and ends, J,e,7,2, reads and ends. J,o and J,w are not answered:
// J,e says what went wrong in them. Between two of them the bus is kept for 100 ms, not more; error 6 is a
// transfer that is not open (any more), 8 one while another is.
//
// ~J,t,12{..} is an address that nobody acknowledged, 13 a byte, 14 a bus that is held low, 15 a chip that
// held the clock for too long, 16 a transfer longer than this board can do it, each with the address.
#pragma once

#include "Asip.h"
#include "asip/I2c.h"

namespace asip {

class I2cChips : public Service {
  public:
    static constexpr uint8_t kMaxOut = 25, kMaxIn = 16;

    // A service has to be a global: what is not set here is zero.
    I2cChips() : Service('J', kHoldsText) {}

    FlashText name() const override;
    void begin() override;
    Error processRequest(Request& request) override;
    void poll() override;
    void reportValue(uint8_t index) override;

  private:
    static constexpr uint8_t kFirst = 0x08, kLast = 0x77;  // the others are reserved
    static constexpr uint8_t kKeepMs = 100;
    enum Step : uint8_t { kIdle, kStarting, kUnderWay, kAnswering };

    // What a request holds, in this order, and does: it ends its transfer, or is not answered.
    enum : uint8_t {
        kHasNumber = 1,
        kHasAddress = 2,
        kHasCount = 4,
        kHasMore = 8,
        kHasBytes = 16,
        kEnds = 32,
        kIsSilent = 64
    };
    static uint8_t traitsOf(char tag);

    bool start();
    void finishPart();
    void found(bool there);
    void settle();
    void finish();
    void answer();
    void sendFault() const;
    void close();

    Step step_;
    char tag_;  // of the request under way, as its traits
    uint8_t traits_;
    bool isOpen_, writes_;
    uint8_t more_;       // I2c::kMore or 0
    uint8_t number_;     // of the transfer that is open, or of chips that were found
    uint8_t direction_;  // in which the part before went, and a part may go on
    uint8_t fault_;
    uint8_t address_;
    uint8_t outCount_, inCount_;
    uint8_t sinceMs_;
    uint8_t bytes_[kMaxOut];  // or a bit for each address that was found
};

}  // namespace asip
