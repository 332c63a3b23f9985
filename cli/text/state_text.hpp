// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "asip/bus/registry/items.hpp"

namespace asip::cli {

/// A state with its reason and time, for a person: `lost 3 min ago: cable unplugged`, `updating for 20 s: its
/// port is in other hands`; the bare word where there is nothing to explain. `age_seconds`: negative where it
/// is not known.
std::string state_text(std::string_view state, std::string_view reason, double age_seconds);
/// The same of a board, as it was when its item was written.
std::string state_text(const bus::BoardItem& board);
/// What a person can do about a board that is not there.
std::string what_to_do(const bus::BoardItem& board);

}  // namespace asip::cli
