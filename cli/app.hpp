// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <iosfwd>
#include <vector>

#include "cli/verb.hpp"

namespace asip::cli {

/// Reads arguments, environment and configuration file, runs one of `verbs`, and returns the exit status.
int run_app(const std::vector<Verb>& verbs, int argc, const char* const* argv, std::istream& in,
            std::ostream& out, std::ostream& err);

}  // namespace asip::cli
