// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "asip/expected.hpp"

namespace asip::model {

/// Checked before a text is parsed.
struct JsonLimits {
    std::size_t max_bytes = std::size_t{64} * 1024;
    int max_depth = 16;  ///< of arrays and objects one inside the other
};

/// `text` nests arrays and objects at most `limit` deep. Cheap, without recursion, for any text: ask it
/// before a parser whose value is walked recursively.
bool json_depth_within(std::string_view text, int limit);

/// Parses text of anyone; never throws, never recurses deeper than the limit. Fails, with a reason, on a text
/// that is too long, too deep, or not valid JSON in UTF-8: then with line and column. Of equal members the
/// last counts.
Expected<nlohmann::json> parse_json(std::string_view text, JsonLimits limits = {});

/// A whole number has no point, as boards take it.
nlohmann::json json_number(double value);

/// Compact. Bytes that are not UTF-8 become U+FFFD; never throws for them.
std::string dump_json(const nlohmann::json& value);
/// Indented by two spaces, for people.
std::string dump_json_pretty(const nlohmann::json& value);

}  // namespace asip::model
