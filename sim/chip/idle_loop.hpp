// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/chip/simavr.hpp"

namespace asip::sim {

/// Firmware that waits repeats one loop until an interrupt. A round that leaves registers and memory as they
/// were, and touches no chip register with an effect or a time, repeats exactly until simavr's next timer:
/// whole rounds pass at once. Cycles stay what they are.
class IdleLoop {
  public:
    /// Once all that handles I/O registers is in place: it goes in front.
    explicit IdleLoop(avr_t& avr);
    IdleLoop(const IdleLoop&) = delete;
    IdleLoop& operator=(const IdleLoop&) = delete;

    /// Between two instructions: finds out within a few hundred cycles whether the firmware waits, and passes
    /// rounds where that pays.
    void pass();

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
