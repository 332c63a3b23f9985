// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "sim/chip/alarm.hpp"
#include "sim/chip/simavr.hpp"

namespace asip::sim {

/// EEPE stays set for 3.4 ms, as on a chip; simavr clears it at once.
class EepromTime {
  public:
    explicit EepromTime(AlarmClock& clock);

    /// A reset does not end a write.
    void after_reset() { show_busy(); }

  private:
    static void control_changed(avr_irq_t* irq, std::uint32_t value, void* param);
    void on_control(std::uint8_t value);
    void show_busy();

    avr_t& avr_;
    avr_eeprom_t* eeprom_ = nullptr;
    Alarm written_;
    std::uint64_t enabled_until_ = 0;  // the cycle at which a set EEMPE ends
};

}  // namespace asip::sim
