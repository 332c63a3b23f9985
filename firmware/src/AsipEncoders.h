// SPDX-License-Identifier: Apache-2.0
// Wheel encoders, two pins each:
//
//   asip::Encoders encoders(2, 4,  3, 12);      // encoder 0, encoder 1
//
// E,A,ms reports @E,e,2,{1500:11,1550:12}: microseconds between the last two edges of the first pin, and
// steps since the last event, negative backwards. A step is an edge of the first pin: two in each cycle.
// Every second wheel (encoders 1 and 3) is counted mirrored, as ASIP 0.4 does it: the wheels of the two sides
// are mounted the other way round, and both count up when the robot drives forwards. A board that wants it
// otherwise says so before asip::board.begin(): encoders.mirror(0) counts all alike, bit N stands for encoder
// N. Steps are counted by interrupts, whatever the board is doing: up to 8,000 cycles a second in all. On a
// pin without one (on a Mega all but 0, 2, 3, 10 to 13, 18 to 21, 50 to 53 and A8 to A15; on a Leonardo all
// but 0 to 3, 7 to 11 and 14 to 17) the loop looks for them: 1,000 a second. On AVR a board with encoders
// steps its line up to 500,000 baud at most: their interrupts leave it no more time.
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
        : Service('E', sizeof...(Pins) / 2), pins_{static_cast<uint8_t>(pins)...}, wheels_(), flags_(0x0A) {
        static_assert(sizeof...(Pins) % 2 == 0, "an encoder has two pins");
        static_assert(sizeof...(Pins) <= 2 * kMaxEncoders, "too many encoders");
    }

    // Which wheels are counted mirrored, one bit each.
    void mirror(uint8_t wheels) { flags_ = wheels & static_cast<uint8_t>(~kNeedsPolling); }

    FlashText name() const override;
    void begin() override;
    Error processRequest(Request& request) override;
    void reportValue(uint8_t index) override;
    void poll() override;

  private:
    struct Wheel {
        constexpr Wheel() : first(), second(), wasHigh(false), steps(0), pulse(0), changed(0) {}

        QuickPin first;
        QuickPin second;
        bool wasHigh;
        int32_t steps;
        uint32_t pulse;    // microseconds
        uint32_t changed;  // when; 0: not yet
    };

    static void onPinChange();
    void connect(uint8_t encoder);
    static void countEdge(Wheel& wheel, uint32_t now);
    bool isMirrored(uint8_t encoder) const { return flags_ >> encoder & 1; }

    uint8_t pins_[2 * kMaxEncoders];
    Wheel wheels_[kMaxEncoders];
    static constexpr uint8_t kNeedsPolling = 128;  // a pin has no interrupt
    uint8_t flags_;                                // and which wheels are mirrored, one bit each
};

}  // namespace asip
