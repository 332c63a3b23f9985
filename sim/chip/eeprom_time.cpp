// SPDX-License-Identifier: Apache-2.0
#include "sim/chip/eeprom_time.hpp"

#include <cstring>

namespace asip::sim {
namespace {

constexpr double kWriteSeconds = 3.4e-3;
constexpr std::uint64_t kEnabledCycles = 5;  // EEPE has to follow EEMPE within four

std::uint8_t mask_of(const avr_regbit_t& bit) {
    return static_cast<std::uint8_t>(bit.mask << bit.bit);
}

}  // namespace

EepromTime::EepromTime(AlarmClock& clock)
    : avr_(clock.avr()), written_(clock, [this] {
          avr_.data[eeprom_->eepe.reg] &= static_cast<std::uint8_t>(~mask_of(eeprom_->eepe));
      }) {
    for (auto* io = avr_.io_port; io != nullptr; io = io->next)
        if (std::strcmp(io->kind, "eeprom") == 0) eeprom_ = reinterpret_cast<avr_eeprom_t*>(io);
    if (eeprom_ == nullptr) return;
    avr_irq_register_notify(avr_iomem_getirq(&avr_, eeprom_->eepe.reg, nullptr, AVR_IOMEM_IRQ_ALL),
                            control_changed, this);
}

void EepromTime::control_changed(avr_irq_t*, std::uint32_t value, void* param) {
    static_cast<EepromTime*>(param)->on_control(static_cast<std::uint8_t>(value));
}

// Called after reads of the register too.
void EepromTime::on_control(std::uint8_t value) {
    if (written_.armed()) return show_busy();
    const bool enables = value & mask_of(eeprom_->eempe);
    const bool writes = value & mask_of(eeprom_->eepe);
    if (writes && avr_.cycle < enabled_until_) {
        written_.at(avr_.cycle + static_cast<std::uint64_t>(kWriteSeconds * avr_.frequency));
        enabled_until_ = 0;
        show_busy();
    } else if (enables && !writes && avr_.cycle >= enabled_until_) {
        enabled_until_ = avr_.cycle + kEnabledCycles;
    }
}

void EepromTime::show_busy() {
    if (written_.armed()) avr_.data[eeprom_->eepe.reg] |= mask_of(eeprom_->eepe);
}

}  // namespace asip::sim
