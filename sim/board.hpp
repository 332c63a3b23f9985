// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "sim/board_kind.hpp"
#include "sim/config.hpp"
#include "sim/wiring/part.hpp"

struct avr_t;

namespace asip::sim {

using Cycles = std::uint64_t;
/// Since the board was switched on.
using SimTime = std::chrono::nanoseconds;

enum class Level { kLow, kHigh };

/// With the cycle at which its stop bit ended.
struct ReceivedByte {
    char byte;
    Cycles cycle;
};

/// Without line end, with the cycle at which its last byte was complete.
struct ReceivedLine {
    std::string text;
    Cycles cycle;
};

/// A part's visible change.
struct Change {
    SimTime time;
    std::string part;   ///< its name
    std::string kind;   ///< "led", ...
    std::string value;  ///< Part::state() after the change, or what happened: "lap 24.100"
};

/// Lost or spoilt on the line since the board was switched on.
struct LineErrors {
    std::uint64_t receive_overruns = 0;  ///< bytes the chip lost: a third byte came while two were unread
    std::uint64_t garbled_to_board = 0;  ///< bytes sent at a rate the board did not have
    std::uint64_t garbled_to_host = 0;   ///< bytes of the board at a rate the host did not have
    /// Bytes of the board not yet sent completely when it changed its rate
    std::uint64_t cut_by_rate_change = 0;
};

enum class ResetCause { kPowerOn, kExternal, kWatchdog };

/// Real firmware in a simulated chip, with parts on its pins. Time passes only in the run functions, so that
/// the same calls give the same result everywhere. Boards share nothing; each may have a thread.
class Board {
  public:
    /// Errors are one line, with the image or the part.
    static Expected<std::unique_ptr<Board>> create(const BoardConfig& config);
    ~Board();
    Board(const Board&) = delete;
    Board& operator=(const Board&) = delete;

    const BoardConfig& config() const;
    const BoardKind& kind() const;

    // --- time

    Cycles cycles() const;
    SimTime now() const;
    SimTime to_time(Cycles cycles) const;

    /// Ends up to 100 cycles late.
    void run_for(SimTime simulated);
    /// Looks at `done()` every 20 us; returns its last value.
    bool run_until(const std::function<bool()>& done, SimTime limit);
    /// False: the firmware stopped the chip for good; only time passes.
    bool alive() const;

    // --- serial line

    /// Each takes ten bit times at the host's rate.
    void send(std::string_view bytes);
    /// Queued bytes whose stop bit has not ended.
    std::size_t sending() const;
    /// Since the last take.
    std::string take_output();
    std::vector<ReceivedByte> take_bytes();
    /// Nothing: `limit` passed. Does not see what take_output() or take_bytes() took.
    std::optional<ReceivedLine> read_line(SimTime limit);
    /// As its stop bit ends; take_output() does not have such bytes.
    void on_byte(std::function<void(char)> callback);

    void set_host_baud(std::uint32_t baud);  ///< as BoardConfig::host_baud
    std::uint32_t host_baud() const;
    /// As the chip rounds it (57600 is 58824 on 16 MHz); 0 while the port is closed.
    std::uint32_t board_baud() const;
    const LineErrors& line_errors() const;

    // --- pins and parts

    /// Whoever drives it.
    Level pin(int arduino_pin) const;
    bool is_output(int arduino_pin) const;
    /// From outside, also a pin that a part has.
    void drive(int arduino_pin, Level level);
    /// Its level is high with a pull-up, else low.
    void release(int arduino_pin);
    void set_millivolts(int arduino_pin, int millivolts);
    /// At every change, with the exact cycle in cycles().
    void on_pin(int arduino_pin, std::function<void(Level)> callback);

    /// Throws std::out_of_range if there is no such part.
    Part& part(std::string_view name);
    Part* find_part(std::string_view name);
    const std::vector<std::unique_ptr<Part>>& parts() const;
    void on_change(std::function<void(const Change&)> callback);

    // --- reset, memory, stack

    /// As button or DTR. RAM stays; bytes on the wire are lost.
    void reset();
    /// As unplugging and plugging in. RAM stays here, which a chip does not promise.
    void power_cycle();
    unsigned resets() const;  ///< since it was created: watchdog, reset() and power_cycle()
    ResetCause last_reset() const;
    void on_reset(std::function<void(ResetCause)> callback);

    /// Registers from 0, I/O from 0x20, RAM from 0x100 (0x200 on a Mega).
    std::uint8_t peek(std::uint16_t address) const;
    void poke(std::uint16_t address, std::uint8_t value);
    /// The address of a global in an .elf image ("_ZN..." mangled): data as in the data space, code in bytes.
    std::optional<std::uint32_t> symbol(std::string_view name) const;

    std::vector<std::uint8_t> eeprom() const;
    void set_eeprom(std::size_t offset, const std::vector<std::uint8_t>& bytes);

    /// As a programmer does: the rest of the flash is erased, the EEPROM stays unless the image has one.
    /// symbol() knows the old image. After an error nothing has changed.
    Expected<void> load(const std::filesystem::path& image);

    /// To BoardConfig::eeprom, if it changed. False: that cannot be written.
    bool save_eeprom();

    /// Follows the stack pointer from now on (about half as fast).
    void watch_stack();
    /// Since watch_stack(), in bytes from the end of RAM, interrupts included.
    unsigned max_stack() const;
    unsigned stack_now() const;

    /// Cycles in which the firmware only waited, not simulated one by one. None with watch_stack().
    Cycles idle() const;

    avr_t* raw();

  private:
    struct Impl;
    explicit Board(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace asip::sim
