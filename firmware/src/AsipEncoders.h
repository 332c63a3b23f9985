// Wheel encoders, two pins each:
//
//   asip::Encoders encoders(2, 4,  3, 12);      // encoder 0, encoder 1
//
// E,A,ms reports @E,e,2,{3000:11,3100:-12}: microseconds between the last two steps, and steps since the last
// event, negative backwards. A step is a rising edge of the first pin; the loop looks for it, so it must be
// high and low for longer than one pass: 0.2 ms are enough.
#pragma once

#include "Asip.h"

namespace asip {

class Encoders : public Service {
  public:
    static constexpr uint8_t kMaxEncoders = 4;

    template <typename... Pins>
    constexpr explicit Encoders(Pins... pins)
        : Service('E', sizeof...(Pins) / 2), pins_{static_cast<uint8_t>(pins)...}, wheels_() {
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
        int16_t steps;
        uint16_t width;
        uint32_t lastStep;
        bool wasHigh;
    };

    uint8_t pins_[2 * kMaxEncoders];
    Wheel wheels_[kMaxEncoders];
};

}  // namespace asip
