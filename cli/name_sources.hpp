// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>

#include "cli/ask/board_source.hpp"
#include "cli/complete.hpp"

namespace asip::cli {

/// From the bus while `connected` holds, and from the models of `environment`. All three must outlive the
/// result.
NameSources bus_names(const Environment& environment, BoardSource& source, std::function<bool()> connected);

}  // namespace asip::cli
