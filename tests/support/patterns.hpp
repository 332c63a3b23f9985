// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace asip::test {

/// Where a text matches a regular expression: the whole, and what is in each pair of brackets. In a source of
/// its own, because std::regex costs the compiler two seconds wherever it is used.
using Match = std::vector<std::string>;

std::optional<Match> first_match(const std::string& text, const std::string& pattern);
std::vector<Match> all_matches(const std::string& text, const std::string& pattern);
std::string without_matches(const std::string& text, const std::string& pattern);

}  // namespace asip::test
