// SPDX-License-Identifier: Apache-2.0
// Motors behind H-bridges, three pins each: forward, backward, power (a PWM pin).
//
//   asip::Motors motors(7, 8, 5,  12, 13, 6);      // motor 0, motor 1
//
// M,m,motor,power (-255 to 255), M,M,power0,power1, M,s,motor stops one, M,S stops all. They are not
// available if a pin is in use elsewhere, or if the PWM of a power pin comes from a timer that another
// service uses (servos, tone).
//
// Clients of robots of 2017 and later ask for encoders by this service: M,A,1 turns reports on, M,A,0 off. A
// sketch that says motors.report(encoders) before asip::board.begin() answers with @M,e as Encoders do with
// @E,e: each 25 ms, or at the period that M,A gives (2 ms or more). Each step is reported once, by M or by E.
#pragma once

#include "Asip.h"

namespace asip {

class Motors : public Service {
  public:
    static constexpr uint8_t kMaxMotors = 4;

    template <typename... Pins>
    constexpr explicit Motors(Pins... pins)
        : Service('M'),
          pins_{static_cast<uint8_t>(pins)...},
          used_(sizeof...(Pins) / 3),
          available_(false),
          reported_(nullptr) {
        static_assert(sizeof...(Pins) % 3 == 0, "a motor has three pins");
        static_assert(sizeof...(Pins) <= 3 * kMaxMotors, "too many motors");
    }

    // Reports the values of `encoders`, another service, as its own.
    void report(Service& encoders) { reported_ = &encoders; }

    FlashText name() const override;
    void begin() override;
    Error processRequest(Request& request) override;
    void reportValue(uint8_t index) override;
    void reportValues() override;

  private:
    static constexpr uint16_t kUsualPeriodMs = 25;

    void setPower(uint8_t motor, int16_t power);
    bool isAvailable() const;

    uint8_t pins_[3 * kMaxMotors];
    uint8_t used_;
    bool available_;  // all pins were free
    Service* reported_;
};

}  // namespace asip
