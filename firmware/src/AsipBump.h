// SPDX-License-Identifier: Apache-2.0
// Bump sensors, switches to ground: B,A,ms reports @B,e,2,{0,1}, 0 while something is touched, 1 while the
// sensor is free.
#pragma once

#include "Asip.h"

namespace asip {

class Bump : public Service {
  public:
    static constexpr uint8_t kMaxSensors = 8;

    template <typename... Pins>
    constexpr explicit Bump(Pins... pins)
        : Service('B', sizeof...(Pins)), pins_{static_cast<uint8_t>(pins)...} {
        static_assert(sizeof...(Pins) <= kMaxSensors, "too many sensors");
    }

    FlashText name() const override;
    void begin() override;
    Error processRequest(Request& request) override;
    void reportValue(uint8_t index) override;

  private:
    uint8_t pins_[kMaxSensors];
};

}  // namespace asip
