// SPDX-License-Identifier: Apache-2.0
#pragma once
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
    OutputOptions output{};
};

/// `asipctl label`: shows labels and friendly names, or asks the agents of the boards to change them.
int run_label(LabelOptions options, Environment& environment);

}  // namespace asip::cli
