// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/board.hpp"
#include "sim/chip/chip.hpp"
#include "sim/chip/eeprom_time.hpp"
#include "sim/chip/idle_loop.hpp"
#include "sim/chip/serial_line.hpp"
#include "sim/wiring/part_context.hpp"
#include "sim/wiring/part_plan.hpp"

namespace asip::sim {

/// What a Board consists of. Order matters: later members refer to earlier ones.
struct Board::Impl {
    Impl(BoardConfig config, const BoardKind& kind, const std::vector<PlannedPart>& parts, Image image,
         std::unique_ptr<Chip> chip, avr_uart_t& port);

    void run_to(Cycles target);
    void reset_from_outside(ResetCause cause);
    void was_reset();
    void tell(const Part& part, std::string value);
    void received(char byte);
    void watch_stack_pointer();
    unsigned stack_depth() const;
    avr_t& avr() { return chip_->avr(); }
    const avr_t& avr() const { return chip_->avr(); }

    BoardConfig config_;
    const BoardKind& kind_;
    std::map<std::string, std::uint32_t, std::less<>> symbols_;
    std::unique_ptr<Chip> chip_;
    AlarmClock clock_;
    EepromTime eeprom_time_;
    Wiring wiring_;
    I2cBus i2c_;
    SerialLine line_;
    Alarm deadline_;
    PartContext context_;
    std::vector<std::unique_ptr<Part>> parts_;
    std::unique_ptr<IdleLoop> idle_loop_;  // once all others have their registers

    std::vector<ReceivedByte> received_;
    std::function<void(char)> on_byte_;
    std::function<void(const Change&)> on_change_;
    std::function<void(ResetCause)> on_reset_;
    bool stop_at_newline_ = false;
    bool stop_ = false;

    unsigned resets_ = 0;
    std::optional<ResetCause> cause_from_outside_;
    ResetCause last_reset_ = ResetCause::kPowerOn;

    std::vector<std::uint8_t> saved_eeprom_;

    bool watching_stack_ = false;
    unsigned max_stack_ = 0;
};

}  // namespace asip::sim
