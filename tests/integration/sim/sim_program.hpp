// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "tests/support/child_process.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {

/// A running asip-sim with its own control socket, stopped when this object goes.
class SimProgram {
  public:
    /// Starts it with these arguments and waits until it has named `boards` ports.
    explicit SimProgram(const TempDir& folder, std::vector<std::string> arguments, int boards = 1);

    ChildProcess& process() { return process_; }
    /// That of the board that was named first.
    const std::string& port() const { return port_; }
    const std::string& socket() const { return socket_; }
    /// The number behind "tcp=" of the first board.
    int tcp_port() const { return tcp_port_; }

    /// asip-sim ctl with these words.
    Finished control(std::vector<std::string> words);
    /// Ends it as a service manager does. Its exit status.
    std::optional<int> terminate();

  private:
    std::string socket_;
    ChildProcess process_;
    std::string port_;
    int tcp_port_ = 0;
};

/// A board file around the monitor sketch (it answers 'E' and a byte with that byte).
std::string board_file(const TempDir& folder, const std::string& name, const std::string& more = "");

}  // namespace asip::test
