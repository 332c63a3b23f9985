// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>

#include "cli/ask/board_source.hpp"
#include "cli/complete.hpp"

namespace asip::cli {

/// Names from the bus, and from the models that `environment` has. Where `connected` does not hold, which is
/// asked before each use of the bus, there are none of it. All three must outlive the result.
NameSources bus_names(const Environment& environment, BoardSource& source, std::function<bool()> connected);

}  // namespace asip::cli
