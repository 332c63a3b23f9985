// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "asip/expected.hpp"

namespace asip::model {

/// What a text may have before it is parsed at all.
struct JsonLimits {
    std::size_t max_bytes = std::size_t{64} * 1024;
    int max_depth = 16;  ///< of arrays and objects one inside the other
};

/// Whether `text` nests arrays and objects at most `limit` deep; brackets inside strings do not count. Cheap
/// and without recursion: ask it before a parser whose value is walked recursively. The text need not be
/// JSON.
bool json_depth_within(std::string_view text, int limit);

/// Parses text that anyone may have written. Never throws and never recurses deeper than the limit. Fails
/// with a reason when the text is longer or deeper than allowed, or is not valid JSON (RFC 8259; strings must
/// be UTF-8): then with line and column. Of members with the same name the last one counts.
Expected<nlohmann::json> parse_json(std::string_view text, JsonLimits limits = {});

/// Compact text. Bytes in strings that are not UTF-8 become U+FFFD; never throws for them.
std::string dump_json(const nlohmann::json& value);
/// The same, indented by two spaces, for people.
std::string dump_json_pretty(const nlohmann::json& value);

}  // namespace asip::model
