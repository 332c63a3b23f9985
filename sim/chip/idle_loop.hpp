// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "sim/chip/simavr.hpp"

namespace asip::sim {

/// Firmware that waits repeats one loop until an interrupt comes, and simulating each round of it is nearly
/// all that a simulated board costs. A round that leaves registers and memory as they were, and has touched
/// no register of the chip whose access does anything or depends on the time, is repeated by the chip exactly
/// until simavr's next timer (what arrives from outside comes by such timers, too): so that time is passed in
/// whole rounds at once. Cycles stay what they are.
class IdleLoop {
  public:
    /// Once all that handles I/O registers of `avr` is in place: it puts itself in front of them.
    explicit IdleLoop(avr_t& avr);
    IdleLoop(const IdleLoop&) = delete;
    IdleLoop& operator=(const IdleLoop&) = delete;

    /// Between two instructions. Runs a few hundred cycles to find out whether the firmware waits, and passes
    /// the rounds in front of the next timer; does nothing where that would not pay.
    void pass();

    /// Cycles that were passed, of all.
    std::uint64_t passed() const { return passed_; }

  private:
    struct Round {
        std::uint64_t cycles;
        unsigned instructions;
    };
    struct Register {
        IdleLoop* self;
        avr_io_read_t read;
        void* read_param;
        avr_io_write_t write;
        void* write_param;
    };

    void watch_registers();
    void watch_reads(Register& watched, std::size_t index);
    void watch_writes(Register& watched, std::size_t index);
    bool is_pin_register(avr_io_addr_t address) const;
    std::optional<Round> find_round(std::uint64_t end);
    void rest();
    void remember();
    bool as_remembered() const;

    avr_t& avr_;
    std::vector<Register> registers_;
    bool touched_ = false;

    avr_flashaddr_t pc_ = 0;
    std::uint64_t since_ = 0;
    std::vector<std::uint8_t> memory_;
    std::array<std::uint8_t, 8> flags_{};

    unsigned usual_instructions_ = 64;
    std::uint64_t rest_ = 0, not_before_ = 0;  ///< cycles without another attempt after one that failed
    std::uint64_t passed_ = 0;
};

}  // namespace asip::sim
