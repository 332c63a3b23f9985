// SPDX-License-Identifier: Apache-2.0
#include "sim/chip/idle_loop.hpp"

#include <algorithm>
#include <cstring>

namespace asip::sim {
namespace {

constexpr std::uint64_t kWorthwhile = 1000;    // cycles until the next timer
constexpr unsigned kMaxInstructions = 4096;    // of a round
constexpr std::uint64_t kFirstRest = 1000;     // cycles
constexpr std::uint64_t kMaxRest = 1'000'000;  // cycles

}  // namespace

IdleLoop::IdleLoop(avr_t& avr) : avr_(avr), registers_(MAX_IOs), memory_(avr.ramend + std::size_t{1}) {
    watch_registers();
}

void IdleLoop::watch_registers() {
    for (std::size_t i = 0; i < registers_.size(); ++i) {
        registers_[i].self = this;
        watch_reads(registers_[i], i);
        watch_writes(registers_[i], i);
    }
}

/// Levels of pins change by interrupts and timers only, and waiting firmware reads them all the time.
bool IdleLoop::is_pin_register(avr_io_addr_t address) const {
    for (const auto* io = avr_.io_port; io != nullptr; io = io->next)
        if (std::strcmp(io->kind, "port") == 0 && reinterpret_cast<const avr_ioport_t*>(io)->r_pin == address)
            return true;
    return false;
}

void IdleLoop::watch_reads(Register& watched, std::size_t index) {
    auto& handler = avr_.io[index].r;
    if (handler.c == nullptr || is_pin_register(static_cast<avr_io_addr_t>(index + kIoBase))) return;
    watched.read = handler.c;
    watched.read_param = handler.param;
    handler.param = &watched;
    handler.c = [](avr_t* avr, avr_io_addr_t address, void* param) {
        auto& one = *static_cast<Register*>(param);
        one.self->touched_ = true;
        return one.read(avr, address, one.read_param);
    };
}

void IdleLoop::watch_writes(Register& watched, std::size_t index) {
    auto& handler = avr_.io[index].w;
    if (handler.c == nullptr && avr_.io[index].irq == nullptr) return;
    watched.write = handler.c;
    watched.write_param = handler.param;
    handler.param = &watched;
    handler.c = [](avr_t* avr, avr_io_addr_t address, std::uint8_t value, void* param) {
        auto& one = *static_cast<Register*>(param);
        one.self->touched_ = true;
        if (one.write != nullptr)
            one.write(avr, address, value, one.write_param);
        else
            avr->data[address] = value;
    };
}

void IdleLoop::pass() {
    const auto* timer = avr_.cycle_timers.timer;
    if (avr_.state != cpu_Running || timer == nullptr || avr_.cycle < not_before_) return;
    const auto end = timer->when;
    if (end < avr_.cycle + kWorthwhile) return;
    const auto limit = avr_.run_cycle_limit;
    avr_.run_cycle_limit = avr_.run_cycle_count = 1;
    if (const auto round = find_round(end)) {
        const auto rounds = (end - 1 - avr_.cycle) / round->cycles;
        avr_.cycle += rounds * round->cycles;
        passed_ += rounds * round->cycles;
        usual_instructions_ = round->instructions;
        rest_ = 0;
    }
    avr_.run_cycle_limit = limit;
}

/// The place that is remembered may be one that does not come again, in an interrupt or in front of the loop:
/// another one is taken then, and given more time.
std::optional<IdleLoop::Round> IdleLoop::find_round(std::uint64_t end) {
    touched_ = false;
    unsigned allowed = usual_instructions_;
    for (bool first = true; allowed <= kMaxInstructions; allowed *= first ? 1 : 2, first = false) {
        remember();
        for (unsigned instructions = 1; instructions <= allowed; ++instructions) {
            avr_run(&avr_);
            if (avr_.cycle >= end) return std::nullopt;
            if (touched_ || avr_.state != cpu_Running) {
                rest();
                return std::nullopt;
            }
            if (as_remembered()) return Round{avr_.cycle - since_, instructions};
        }
    }
    rest();
    return std::nullopt;
}

void IdleLoop::rest() {
    rest_ = std::clamp(rest_ * 2, kFirstRest, kMaxRest);
    not_before_ = avr_.cycle + rest_;
}

void IdleLoop::remember() {
    pc_ = avr_.pc;
    since_ = avr_.cycle;
    std::copy_n(avr_.data, memory_.size(), memory_.begin());
    std::copy_n(avr_.sreg, flags_.size(), flags_.begin());
}

bool IdleLoop::as_remembered() const {
    return avr_.pc == pc_ && avr_.interrupt_state == 0 &&
           std::equal(flags_.begin(), flags_.end(), avr_.sreg) &&
           std::memcmp(memory_.data(), avr_.data, memory_.size()) == 0;
}

}  // namespace asip::sim
