// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/types.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/wait.hpp"

namespace asip::test {

/// What a terminal shows of what was written to it: text, and the movements that TERM=xterm has.
class Screen {
  public:
    Screen(std::size_t rows, std::size_t columns) : lines_(rows, std::string(columns, ' ')) {}

    void write(const std::string& bytes);
    /// Without the blanks at its end.
    std::string line(std::size_t row) const;
    std::size_t row() const { return row_; }
    std::size_t column() const { return column_; }
    /// All lines, joined by line ends.
    std::string text() const;

  private:
    void put(char c);
    void control(char final);
    void line_feed();

    std::vector<std::string> lines_;
    std::size_t row_ = 0, column_ = 0;
    std::string sequence_;  // of an escape that is not complete
};

/// A program on a real pseudo-terminal of 24 rows and 80 columns. Killed when this object goes.
class TerminalProcess {
  public:
    /// As ChildProcess; TERM is xterm. Throws std::runtime_error when it cannot be started.
    explicit TerminalProcess(std::vector<std::string> arguments,
                             std::map<std::string, std::string> environment = {});
    ~TerminalProcess();
    TerminalProcess(const TerminalProcess&) = delete;
    TerminalProcess& operator=(const TerminalProcess&) = delete;

    pid_t pid() const;
    void type(const std::string& keys);
    void resize(unsigned short rows, unsigned short columns);

    /// What is on the screen now.
    Screen screen() const;
    /// Whether a line of the screen comes to contain a match of the ECMAScript regular expression.
    bool shows(const std::string& pattern, std::chrono::milliseconds limit = kDeadline) const;
    /// Whether the line with the cursor becomes exactly this.
    bool edits(const std::string& line, std::chrono::milliseconds limit = kDeadline) const;

    /// As ChildProcess::wait_exit().
    std::optional<int> wait_exit(std::chrono::milliseconds limit = kDeadline);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace asip::test
