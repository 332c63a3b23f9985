// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <iosfwd>

namespace asip::cli {

/// Reads arguments, environment and configuration file, runs the verb, and returns the exit status.
int run_app(int argc, const char* const* argv, std::istream& in, std::ostream& out, std::ostream& err);

}  // namespace asip::cli
