// SPDX-License-Identifier: Apache-2.0
// Ultrasonic distance sensors with trigger and echo on one pin each, in centimetres; 0 where nothing echoes
// within 4 metres.
//
//   asip::Distance distance(7, 8);      // sensor 0 on pin 7, sensor 1 on pin 8
//   void setup() { asip::board.add(distance); ... }
//
// D,M measures once, D,A,ms periodically; both are answered by @D,e,2,{42,118}. The sensors measure one after
// the other, up to 25 ms each (40 with nothing in range), and the board does not wait for them.
#pragma once

#include "Asip.h"

namespace asip {

class Distance : public Service {
  public:
    static constexpr uint8_t kMaxSensors = 6;

    template <typename... Pins>
    constexpr explicit Distance(Pins... pins)
        : Service('D', sizeof...(Pins)),
          pins_{static_cast<uint8_t>(pins)...},
          centimetres_(),
          sensor_(kIdle) {
        static_assert(sizeof...(Pins) <= kMaxSensors, "too many sensors");
    }

    FlashText name() const override;
    void begin() override;
    Error processRequest(Request& request) override;
    void reportValue(uint8_t index) override;
    void reportValues() override;  // starts to measure
    void poll() override;          // goes on measuring, and reports at the end

  private:
    void turnTo(uint8_t sensor);

    static constexpr uint8_t kIdle = 255;

    uint8_t pins_[kMaxSensors];
    uint16_t centimetres_[kMaxSensors];
    uint8_t sensor_;  // measuring now; count() when all are done and the report waits for the line
};

}  // namespace asip
