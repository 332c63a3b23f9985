// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
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
/// Simulated time since the board was switched on. Never the computer's clock.
using SimTime = std::chrono::nanoseconds;

enum class Level { kLow, kHigh };

/// One byte the host received, with the cycle at which its stop bit ended.
struct ReceivedByte {
    char byte;
    Cycles cycle;
};

/// One line the host received (without its line end), with the cycle at which its last byte was complete.
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

/// What was lost or spoilt on the line since the board was switched on.
struct LineErrors {
    std::uint64_t receive_overruns = 0;  ///< bytes the chip lost: a third byte came while two were unread
    std::uint64_t garbled_to_board = 0;  ///< bytes sent at a rate the board did not have
    std::uint64_t garbled_to_host = 0;   ///< bytes of the board at a rate the host did not have
    /// Bytes of the board not yet sent completely when it changed its rate
    std::uint64_t cut_by_rate_change = 0;
};

enum class ResetCause { kPowerOn, kExternal, kWatchdog };

/// A simulated Arduino board: real firmware in a simulated chip, with parts on its pins. Time passes only in
/// the run functions, so that the same calls give the same result on every machine. One thread at a time;
/// boards do not share anything, so that each may have a thread.
class Board {
  public:
    /// Loads the image and wires the parts. Errors are one line each, naming the image or the part and what
    /// is wrong.
    static Expected<std::unique_ptr<Board>> create(const BoardConfig& config);
    /// Writes the EEPROM back to its file, if it has one.
    ~Board();
    Board(const Board&) = delete;
    Board& operator=(const Board&) = delete;

    const BoardConfig& config() const;
    const BoardKind& kind() const;

    // --- time

    Cycles cycles() const;
    SimTime now() const;
    SimTime to_time(Cycles cycles) const;

    /// Runs until `simulated` has passed. Ends up to 100 cycles late (the chip finishes an instruction).
    void run_for(SimTime simulated);
    /// Runs until `done()` (looked at every 20 us) or until `limit` has passed. The last value of done().
    bool run_until(const std::function<bool()>& done, SimTime limit);
    /// False once the firmware has stopped the chip for good (sleep with interrupts off, a jump out of the
    /// flash). Running it then only lets time pass.
    bool alive() const;

    // --- serial line

    /// Queues bytes. Each takes ten bit times on the line, at the rate that the host has now.
    void send(std::string_view bytes);
    /// Bytes queued whose stop bit has not ended.
    std::size_t sending() const;
    /// All bytes received since the last take.
    std::string take_output();
    std::vector<ReceivedByte> take_bytes();
    /// Runs until a complete line was received and removes it; nothing if `limit` passes. Does not see what
    /// take_output() or take_bytes() took.
    std::optional<ReceivedLine> read_line(SimTime limit);
    /// Called for each byte as its stop bit ends; such bytes are not kept for take_output().
    void on_byte(std::function<void(char)> callback);

    void set_host_baud(std::uint32_t baud);  ///< as BoardConfig::host_baud
    std::uint32_t host_baud() const;
    /// The rate that the firmware has set now, rounded as the chip rounds it (57600 is 58824 on 16 MHz); 0
    /// while its serial port is closed.
    std::uint32_t board_baud() const;
    const LineErrors& line_errors() const;

    // --- pins and parts

    /// The level of the pin, whether the firmware, a part or a test drives it.
    Level pin(int arduino_pin) const;
    bool is_output(int arduino_pin) const;
    /// Drives a pin from outside (nothing stops a test from driving one that a part has).
    void drive(int arduino_pin, Level level);
    /// Stops driving it: its level is high with a pull-up, otherwise low.
    void release(int arduino_pin);
    /// Puts a voltage on an analog pin.
    void set_millivolts(int arduino_pin, int millivolts);
    /// Called at every level change of the pin, with the exact cycle in cycles().
    void on_pin(int arduino_pin, std::function<void(Level)> callback);

    /// Throws std::out_of_range if there is no such part: a test's mistake.
    Part& part(std::string_view name);
    Part* find_part(std::string_view name);
    const std::vector<std::unique_ptr<Part>>& parts() const;
    /// Called for every visible change of a part.
    void on_change(std::function<void(const Change&)> callback);

    // --- reset, memory, stack

    /// As the reset button or DTR does it. RAM keeps its content, as on a chip; bytes on the wire are lost.
    void reset();
    /// As unplugging and plugging in again does it. RAM keeps its content here, which a chip does not
    /// promise.
    void power_cycle();
    unsigned resets() const;  ///< since it was created: watchdog, reset() and power_cycle()
    ResetCause last_reset() const;
    void on_reset(std::function<void(ResetCause)> callback);

    /// Data space: registers from 0, I/O from 0x20, RAM from 0x100 (0x200 on a Mega).
    std::uint8_t peek(std::uint16_t address) const;
    void poke(std::uint16_t address, std::uint8_t value);
    /// Address of a global in an .elf image ("_ZN..." mangled): data addresses as in the data space, code in
    /// bytes.
    std::optional<std::uint32_t> symbol(std::string_view name) const;

    std::vector<std::uint8_t> eeprom() const;
    void set_eeprom(std::size_t offset, const std::vector<std::uint8_t>& bytes);

    /// Writes the EEPROM to BoardConfig::eeprom if it changed since. False if that cannot be written.
    bool save_eeprom();

    /// From now on follows the stack pointer after each instruction (about half as fast).
    void watch_stack();
    /// Maximum of the bytes of stack in use since watch_stack(), from the end of RAM, interrupts included.
    unsigned max_stack() const;
    /// Stack in use now.
    unsigned stack_now() const;

    /// Cycles of cycles() in which the firmware only waited, passed without simulating each instruction. None
    /// with watch_stack().
    Cycles idle() const;

    /// The simulator underneath, for what is not offered here.
    avr_t* raw();

  private:
    struct Impl;
    explicit Board(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace asip::sim
