// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>

#include "cli/environment.hpp"

namespace asip::cli {

/// The shell on a terminal: follows the board while lines are typed, and runs each as a process of its own.
class InteractiveShell {
  public:
    InteractiveShell(Environment& environment, std::string board, bool values);
    ~InteractiveShell();

    /// Until `exit` or Ctrl-D.
    int run();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The arguments of asipctl for words that expand_words() gave: after those options that name the bus and
/// were typed.
std::vector<std::string> arguments_for(const Environment& environment, std::vector<std::string> words);

/// What `help` shows in the shell.
std::string shell_help(const std::string& board);

}  // namespace asip::cli
