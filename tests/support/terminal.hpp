// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/wait.hpp"

namespace asip::test {

/// A program on a real pseudo-terminal of 24 rows and 80 columns. Killed when this object goes.
class TerminalProcess {
  public:
    /// As ChildProcess; TERM is xterm. Throws std::runtime_error when it cannot be started.
    explicit TerminalProcess(std::vector<std::string> arguments,
                             std::map<std::string, std::string> environment = {});
    ~TerminalProcess();
    TerminalProcess(const TerminalProcess&) = delete;
    TerminalProcess& operator=(const TerminalProcess&) = delete;

    void type(const std::string& keys);

    /// All that was written to the terminal, without escape sequences.
    std::string written() const;
    /// Whether a match of the ECMAScript regular expression, in which `$` is the end of a line, comes to be
    /// written.
    bool shows(const std::string& pattern, std::chrono::milliseconds limit = kDeadline) const;

    /// As ChildProcess::wait_exit().
    std::optional<int> wait_exit(std::chrono::milliseconds limit = kDeadline);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace asip::test
