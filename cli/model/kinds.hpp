// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "cli/environment.hpp"
#include "cli/output.hpp"

namespace asip::cli {

/// That this program knows.
int list_kinds(const OutputOptions& output, Environment& environment);

/// What a kind reports and takes. An unknown kind is looked for on the bus.
int explain_kind(const std::string& kind, const OutputOptions& output, Environment& environment);

}  // namespace asip::cli
