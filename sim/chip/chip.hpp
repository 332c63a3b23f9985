// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <optional>

#include "asip/expected.hpp"
#include "sim/board_kind.hpp"
#include "sim/chip/image.hpp"
#include "sim/chip/simavr.hpp"

namespace asip::sim {

/// A simavr chip with an image in its flash, set up so that it behaves as the real one where simavr 1.6 does
/// not: its INT0 and INT1 are not polled while their pin is low, an interrupt takes its four cycles to enter,
/// and it never sleeps by the computer's clock.
class Chip {
  public:
    static Expected<std::unique_ptr<Chip>> create(const BoardKind& kind, std::uint32_t frequency,
                                                  const Image& image);
    ~Chip();
    Chip(const Chip&) = delete;
    Chip& operator=(const Chip&) = delete;

    avr_t& avr() { return *avr_; }
    const avr_t& avr() const { return *avr_; }
    /// Null if the chip has no such USART.
    avr_uart_t* uart(char name);

    /// Called inside every reset, the watchdog's too, after simavr's own reset.
    void on_reset(std::function<void()> callback) { reset_callback_ = std::move(callback); }

    /// False once it has stopped for good.
    bool alive() const;
    /// Runs for about 100 cycles (one instruction with `step_`), or sleeps to the next timer.
    void run_a_little() { avr_run(avr_); }
    /// simavr 1.6 does not know timers that count up and down (phase-correct PWM, as Arduino's start-up code
    /// sets two of them), and lets each overflow with every count: half of what a board costs, for nothing.
    void cancel_unknown_timers();
    void single_step(bool on) { avr_->run_cycle_limit = on ? 1 : kBatchCycles; }

    std::vector<std::uint8_t> eeprom();
    void set_eeprom(std::size_t offset, const std::vector<std::uint8_t>& bytes);

  private:
    static constexpr unsigned kBatchCycles = 100;
    // simavr calls back with the address of its first member.
    struct ResetHook {
        avr_io_t io;
        Chip* chip;
    };

    explicit Chip(avr_t* avr);
    void apply_fixes();
    void count_interrupt_entries();
    void free_what_terminate_leaves();

    avr_t* avr_;
    ResetHook hook_{};
    std::function<void()> reset_callback_;
};

}  // namespace asip::sim
