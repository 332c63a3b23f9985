// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <string_view>

namespace asip::bus {

/// The text of a member of the object in `payload`, as it is written there; empty where there is none. Of
/// several of that name the last.
std::string_view written_member(std::string_view payload, std::string_view name);

/// Numbers that stand for something are kept as they are written: of 23 digits a float would hold 16. Each of
/// these members of `object`, which was read from `payload`, becomes a string where it is such a number.
void keep_numbers(std::string_view payload, nlohmann::json& object,
                  std::initializer_list<std::string_view> names);

}  // namespace asip::bus
