// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <span>
#include <string_view>

#include "asip/program/log.hpp"

namespace asip::program::log {

std::string_view name_of(Level level);  ///< what parse_level() reads

/// Is called for each line at `level` or above, also for those that are not printed; not for lines that it
/// logs itself. One at a time; an empty one ends it.
using Observer = std::function<void(Level level, std::string_view text, std::span<const Field> fields)>;
void observe(Level level, Observer observer);

}  // namespace asip::program::log
