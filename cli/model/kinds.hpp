// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "cli/environment.hpp"
#include "cli/output.hpp"

namespace asip::cli {

/// The kinds of service that this program knows.
int list_kinds(const OutputOptions& output, Environment& environment);

/// What a kind of service reports and takes. The bus is asked for a kind that is not known here: a board may
/// have brought its model.
int explain_kind(const std::string& kind, const OutputOptions& output, Environment& environment);

}  // namespace asip::cli
