// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "asip/bus/request/agent_requests.hpp"
#include "asip/expected.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {

/// BOARD/SERVICE/..., taken apart: the id of a property is everything behind the board. Empty: `text` is a
/// board, or a service of one.
std::string property_in(std::string& text);

/// Words that give a meaning to the property `id` go into `change`; fails at one that is none.
Expected<void> add_meanings(model::LabelChange& change, const std::string& id,
                            const std::vector<std::string>& words);

/// Friendly names of pins that are written as find_pin() takes them: `pin.A0=light`; nothing removes a name.
using PinNames = std::map<std::string, std::optional<std::string>>;

/// Takes those words that name a pin otherwise than by its number.
PinNames take_pin_names(std::vector<std::string>& words);

/// Rows of TARGET, KEY and VALUE for all that a board has.
void add_rows(Table& table, const std::string& board, const model::Labels& labels);

}  // namespace asip::cli
