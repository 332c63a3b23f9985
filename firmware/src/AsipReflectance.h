// SPDX-License-Identifier: Apache-2.0
// Infrared reflectance sensors on analog pins, with one pin that switches their emitters on for each
// measurement:
//
//   asip::Reflectance reflectance(4, A0, A1, A2);      // emitters on pin 4
//
// R,A,ms reports @R,e,3,{100,200,300}, 0 to 1023. If the emitters' pin is in use elsewhere, R,A is refused.
#pragma once

#include "Asip.h"

namespace asip {

class Reflectance : public Service {
  public:
    // Each place takes a byte of RAM.
    static constexpr uint8_t kMaxSensors = hw::kAnalogChannels < 8 ? hw::kAnalogChannels : 8;

    template <typename... Pins>
    constexpr explicit Reflectance(uint8_t emitter, Pins... pins)
        : Service('R', sizeof...(Pins)),
          pins_{static_cast<uint8_t>(pins)...},
          emitter_(emitter),
          sensors_(sizeof...(Pins)),
          warming_(false),
          since_(0) {
        static_assert(sizeof...(Pins) <= kMaxSensors, "too many sensors");
    }

    FlashText name() const override;
    void begin() override;
    Error processRequest(Request& request) override;
    void reportValue(uint8_t index) override;
    void reportValues() override;  // switches the emitters on
    void poll() override;          // and reports a little later

  private:
    uint8_t pins_[kMaxSensors == 0 ? 1 : kMaxSensors];  // a chip may have no converter
    uint8_t emitter_;
    uint8_t sensors_;
    bool warming_;
    uint16_t since_;
};

}  // namespace asip
