// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cli/environment.hpp"
#include "cli/output.hpp"

namespace asip::cli {

/// Prints the registries of the bus and what they counted. kExitNoAnswer: there is none.
int list_registries(const OutputOptions& output, Environment& environment);

}  // namespace asip::cli
