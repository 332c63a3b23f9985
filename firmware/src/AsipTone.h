// SPDX-License-Identifier: Apache-2.0
// A loudspeaker or buzzer: T,P,hertz,milliseconds plays a tone while everything else goes on; 0 hertz is
// silence. The Arduino core makes it with timer 2: no PWM then on pins 3 and 11 (Mega: 9 and 10). On a
// Leonardo, where it would take timer 3 and with it pin 5, ToneTimer makes it with timer 1: no PWM then on 9
// and 10.
#pragma once

#include "Asip.h"

namespace asip {

class Tone : public Service {
  public:
    constexpr explicit Tone(uint8_t pin) : Service('T'), pin_(pin) {}

    FlashText name() const override;
    void begin() override;
    Error processRequest(Request& request) override;

  private:
    uint8_t pin_;
};

}  // namespace asip
