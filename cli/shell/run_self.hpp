// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "asip/expected.hpp"

namespace asip::cli {

/// asipctl once more, as a process of its own with our output.
struct SelfRun {
    std::vector<std::string> arguments;
    bool with_input = false;  ///< it may read our standard input, a terminal; else it reads nothing
    /// Works until `ended` holds, and calls it often. When it returns earlier, the process is ended. Empty:
    /// nothing else is to be done.
    std::function<void(const std::function<bool()>& ended)> wait{};
};

/// Its exit status, 128 + signal when killed by one. The kernel ends it when we die. Fails where it cannot be
/// started.
Expected<int> run_self(const SelfRun& run);

}  // namespace asip::cli
