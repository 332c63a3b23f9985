// SPDX-License-Identifier: Apache-2.0
// Wheel encoders, two pins each:
//
//   asip::Encoders encoders(2, 4,  3, 12);      // encoder 0, encoder 1
//
// E,A,ms reports @E,e,2,{3000:11,3100:-12}: microseconds that the last whole cycle of the first pin took, and
// steps since the last event, negative backwards. A step is an edge of the first pin: two in each cycle.
// Steps are counted by interrupts, whatever the board is doing: up to 8,000 cycles a second in all. On a pin
// without one (on a Mega all but 0, 2, 3, 10 to 15, 18 to 21, 50 to 53 and A8 to A15; on a Leonardo all but 0
// to 3, 7 to 11 and 14 to 17) the loop looks for them: 1,000 a second.
// On AVR a board with encoders steps its line up to 500,000 baud at most: their interrupts leave it no more
// time.
#pragma once

#include "Asip.h"
#include "asip/QuickPin.h"

namespace asip {

// At most one on a board.
class Encoders : public Service {
  public:
    // Each takes 21 bytes of RAM: two where that is 2 kB.
#if defined(RAMEND) && RAMEND <= 0x8FF
    static constexpr uint8_t kMaxEncoders = 2;
#else
    static constexpr uint8_t kMaxEncoders = 4;
#endif

    template <typename... Pins>
    constexpr explicit Encoders(Pins... pins)
        : Service('E', sizeof...(Pins) / 2),
          pins_{static_cast<uint8_t>(pins)...},
          wheels_(),
          needsPolling_(false) {
        static_assert(sizeof...(Pins) % 2 == 0, "an encoder has two pins");
        static_assert(sizeof...(Pins) <= 2 * kMaxEncoders, "too many encoders");
    }

    FlashText name() const override;
    void begin() override;
    Error processRequest(Request& request) override;
    void reportValue(uint8_t index) override;
    void poll() override;

  private:
    struct Wheel {
        constexpr Wheel() : first(), second(), wasHigh(false), steps(0), cycle(0), rose(0) {}

        QuickPin first;
        QuickPin second;
        bool wasHigh;
        int32_t steps;
        uint32_t cycle;  // microseconds
        uint32_t rose;   // when; 0: not yet
    };

    static void onPinChange();
    void connect(uint8_t encoder);
    static void look(Wheel& wheel);

    uint8_t pins_[2 * kMaxEncoders];
    Wheel wheels_[kMaxEncoders];
    bool needsPolling_;  // a pin has no interrupt
};

}  // namespace asip
