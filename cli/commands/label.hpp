// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "cli/environment.hpp"
#include "cli/find/chosen_boards.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct LabelOptions {
    std::string target;
    std::vector<std::string> words;  ///< as model::add_assignment() takes them
    SelectorText selector{};
    /// Of one board: a pin as find_pin() takes it, and its new friendly name; nothing removes the name.
    std::string pin{};
    std::optional<std::string> pin_name{};
    OutputOptions output{};
};

/// `asipctl label`: shows labels and friendly names, or asks the agents of the boards to change them.
int run_label(LabelOptions options, Environment& environment);

/// What it prints, for a verb of another name.
inline const std::vector<std::string> kLabelFields{"board",     "labels", "names", "labels_fault",
                                                   "set_aside", "status", "error", "reason"};

}  // namespace asip::cli
