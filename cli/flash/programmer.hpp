// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "asip/descriptor.hpp"
#include "asip/expected.hpp"
#include "asip/time.hpp"

namespace asip::cli {

/// How firmware is brought into a board.
struct Programming {
    std::string image;     ///< .hex or .elf
    std::string path;      ///< the port
    std::string chip;      ///< as the board answered it: "ATmega328P"; may be empty
    std::string part{};    ///< as avrdude calls it, in place of what the chip suggests
    std::string method{};  ///< avrdude's programmer, likewise
    std::size_t baud = 0;  ///< of the boot loader; 0: the usual one of the chip
    std::string avrdude = "avrdude";
};

/// The call of avrdude. Fails where the chip is not known and no part is given, or the image is neither a
/// .hex nor an .elf file.
Expected<std::vector<std::string>> avrdude_call(const Programming& what);

/// The call that exchanges the image of a simulated board. `socket`: of asip-sim; empty: its usual one.
std::vector<std::string> simulator_call(const std::string& board, const std::string& image,
                                        const std::string& socket);

/// Whether a port is a pseudo-terminal: that of a simulated board.
bool is_simulated_port(const std::string& path);

/// Fails for what is neither that nor a serial device of this machine: the board's agent names the port, and
/// no other file is opened on its word.
Expected<void> check_port(const std::string& path);

/// A program that runs beside this one; what it prints goes to standard error. It inherits descriptors that
/// are not closed on exec, and goes on when this program dies.
class RunningProgram {
  public:
    /// Looked up in PATH. Fails where it cannot be started.
    static Expected<RunningProgram> start(const std::vector<std::string>& call);

    /// Its exit status (128 + signal) once it has ended.
    std::optional<int> ended();
    /// Asks it to end, or ends it. Only while ended() is nothing.
    void stop(bool by_force);
    /// The same, once it has.
    int wait();

  private:
    explicit RunningProgram(int pid) : pid_(pid) {}
    int pid_;
};

/// The port's lock, as agents take it: as long as a program has it, no agent opens the port. Programs started
/// meanwhile inherit it, so that it outlives this one.
class PortLock {
  public:
    /// Fails where the port is not there, or another program has it for longer than kPatience: some look for
    /// their device at each port that became free. `pause` passes the time between two attempts.
    static Expected<PortLock> take(const std::string& path, const std::function<void(Duration)>& pause);
    static constexpr Duration kPatience = std::chrono::seconds(2);

  private:
    explicit PortLock(Descriptor port) : port_(std::move(port)) {}
    Descriptor port_;
};

}  // namespace asip::cli
