// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>

#include "asip/expected.hpp"
#include "sim/board_kind.hpp"
#include "sim/chip/image.hpp"
#include "sim/chip/simavr.hpp"

namespace asip::sim {

/// A simavr chip with an image, mended where simavr 1.6 differs: INT0 and INT1 are not polled while low, the
/// pins A8 to A15 of a Mega have their interrupt, an interrupt takes its four cycles, and it never sleeps by
/// the computer's clock.
class Chip {
  public:
    static Expected<std::unique_ptr<Chip>> create(const BoardKind& kind, std::uint32_t frequency,
                                                  const Image& image);
    ~Chip();
    Chip(const Chip&) = delete;
    Chip& operator=(const Chip&) = delete;

    avr_t& avr() { return *avr_; }
    const avr_t& avr() const { return *avr_; }
    /// Null: none.
    avr_uart_t* uart(char name);

    /// Inside every reset, the watchdog's too, after simavr's own.
    void on_reset(std::function<void()> callback) { reset_callback_ = std::move(callback); }

    /// False: stopped for good.
    bool alive() const;
    /// About 100 cycles (one instruction with `step_`), or to the next timer.
    void run_a_little() { avr_run(avr_); }
    /// simavr 1.6 lets phase-correct timers overflow with every count: half of what a board costs, for
    /// nothing.
    void cancel_unknown_timers();
    void single_step(bool on) { avr_->run_cycle_limit = on ? 1 : kBatchCycles; }

    /// All of the flash. An image that begins behind address 0 is a boot loader, where the chip then starts.
    void set_flash(const Image& image);
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
    void add_pin_changes();
    void count_interrupt_entries();
    void free_what_terminate_leaves();

    avr_t* avr_;
    ResetHook hook_{};
    std::function<void()> reset_callback_;
};

}  // namespace asip::sim
