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

/// The id of a property: everything behind the board. Empty: `text` is a board, or a service of one.
std::string property_in(std::string& text);

/// Fails at a word that gives no meaning to `id`.
Expected<void> add_meanings(model::LabelChange& change, const std::string& id,
                            const std::vector<std::string>& words);

/// As find_pin() takes them: `pin.A0=light`; nothing removes a name.
using PinNames = std::map<std::string, std::optional<std::string>>;

/// The words that name a pin otherwise than by its number.
PinNames take_pin_names(std::vector<std::string>& words);

/// TARGET, KEY and VALUE of all that a board has.
void add_rows(Table& table, const std::string& board, const model::Labels& labels);

}  // namespace asip::cli
