// SPDX-License-Identifier: Apache-2.0
// Servos on any pins: S,W,servo,angle turns one to 0..180 degrees (pulses of 544 to 2400 microseconds, every
// 20 ms); S,M,count,pin,... puts the servos on other pins. At start, and on other pins, they turn to the
// middle.
//
//   asip::Servos servos(9, 10);
//
// Timer 1 makes the pulses: with servos, its pins (Uno 9 and 10, Leonardo 9 to 11, Mega 11 to 13) have no PWM
// but where another timer makes it (Leonardo 10 and 11, Mega 13).
#pragma once

#if defined(ARDUINO) && !defined(__AVR__)
#error "AsipServos.h makes its pulses with a timer of an AVR: there is none on this chip"
#endif

#include "Asip.h"
#include "asip/parts/ServoPulses.h"

namespace asip {

class Servos : public Service {
  public:
    static constexpr uint8_t kMaxServos = ServoPulses::kMaxServos;

    template <typename... Pins>
    constexpr explicit Servos(Pins... pins)
        : Service('S'), pins_{static_cast<uint8_t>(pins)...}, used_(sizeof...(Pins)), available_(false) {
        static_assert(sizeof...(Pins) <= kMaxServos, "too many servos");
    }

    FlashText name() const override;
    void begin() override;
    Error processRequest(Request& request) override;

  private:
    Error write(Request& request);
    Error remap(Request& request);

    uint8_t pins_[kMaxServos];
    uint8_t used_;
    bool available_;  // all pins were free
};

}  // namespace asip
