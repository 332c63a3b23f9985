// SPDX-License-Identifier: Apache-2.0
#include "sim/board_impl.hpp"

namespace asip::sim {
namespace {

constexpr std::uint16_t kMcusr = 0x54;
constexpr std::uint8_t kPowerOn = 0x01;
constexpr std::uint8_t kExternal = 0x02;
constexpr std::uint16_t kStackPointerLow = 0x5d;
constexpr std::uint16_t kStackPointerHigh = 0x5e;

}  // namespace

Board::Impl::Impl(BoardConfig config, const BoardKind& kind, const std::vector<PlannedPart>& parts,
                  Image image, std::unique_ptr<Chip> chip, avr_uart_t& port)
    : config_(std::move(config)),
      kind_(kind),
      symbols_(std::move(image.symbols)),
      chip_(std::move(chip)),
      clock_(chip_->avr()),
      eeprom_time_(clock_),
      wiring_(chip_->avr(), kind),
      i2c_(clock_, wiring_, kind.sda, kind.scl),
      line_(port, clock_, config_.frequency, [this](char byte) { received(byte); }),
      deadline_(clock_, [] {}),
      context_{wiring_,
               clock_,
               i2c_,
               config_.frequency / 1e6,
               [this](const Part& part) { tell(part, part.state()); },
               [this](const Part& part, std::string what) { tell(part, std::move(what)); },
               config_.world} {
    line_.set_host_baud(config_.host_baud);
    avr().data[kMcusr] = kPowerOn;
    chip_->on_reset([this] { was_reset(); });
    saved_eeprom_ = chip_->eeprom();
    for (const auto& part : parts)
        parts_.push_back(part.plan.make(part.name, context_));
    idle_loop_ = std::make_unique<IdleLoop>(avr());
}

void Board::Impl::tell(const Part& part, std::string value) {
    if (!on_change_) return;
    const auto now = static_cast<std::int64_t>(clock_.cycle() * 1e9 / config_.frequency);
    on_change_({std::chrono::nanoseconds(now), part.name(), std::string(part.kind().name), std::move(value)});
}

void Board::Impl::run_to(Cycles target) {
    // Without it a sleeping chip would run on to its own next timer.
    deadline_.at(target);
    chip_->cancel_unknown_timers();
    while (clock_.cycle() < target && !stop_) {
        if (!chip_->alive()) {
            avr().cycle = target;
            break;
        }
        if (!watching_stack_) idle_loop_->pass();
        chip_->run_a_little();
        if (watching_stack_) watch_stack_pointer();
    }
    deadline_.cancel();
}

void Board::Impl::reset_from_outside(ResetCause cause) {
    cause_from_outside_ = cause;
    avr_reset(&avr());
    cause_from_outside_.reset();
}

void Board::Impl::was_reset() {
    ++resets_;
    last_reset_ = cause_from_outside_.value_or(ResetCause::kWatchdog);
    // After the watchdog simavr sets its flag itself.
    if (cause_from_outside_) avr().data[kMcusr] = last_reset_ == ResetCause::kPowerOn ? kPowerOn : kExternal;
    line_.after_reset();
    clock_.rearm();
    eeprom_time_.after_reset();
    wiring_.after_reset();
    i2c_.after_reset();
    for (auto& part : parts_)
        part->after_reset();
    if (on_reset_) on_reset_(last_reset_);
}

void Board::Impl::received(char byte) {
    if (on_byte_) {
        on_byte_(byte);
        return;
    }
    received_.push_back({byte, clock_.cycle()});
    if (stop_at_newline_ && byte == '\n') stop_ = true;
}

unsigned Board::Impl::stack_depth() const {
    const auto& data = avr().data;
    const unsigned pointer = data[kStackPointerLow] | data[kStackPointerHigh] << 8;
    // Before the start-up code has set it, it may be anywhere.
    return pointer > avr().ramend || pointer < 0x100 ? 0 : avr().ramend - pointer;
}

void Board::Impl::watch_stack_pointer() {
    max_stack_ = std::max(max_stack_, stack_depth());
}

}  // namespace asip::sim
