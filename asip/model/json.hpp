#pragma once
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "asip/expected.hpp"

namespace asip::model {

struct JsonLimits {
    std::size_t max_bytes = std::size_t{64} * 1024;
    int max_depth = 16;
};

/// Whether `text` nests arrays and objects at most `limit` deep; brackets inside strings do not count. Cheap
/// and without recursion: to be asked before a parser whose value would be walked recursively.
bool json_depth_within(std::string_view text, int limit);

/// Parses text that anyone may have written. Never throws and never recurses deeper than the limit; fails
/// with a reason when the text is too long, too deep, or no JSON (strings must be UTF-8). Duplicate keys: the
/// last one counts.
Expected<nlohmann::json> parse_json(std::string_view text, JsonLimits limits = {});

/// Compact text; bytes that are not UTF-8 become U+FFFD instead of an exception.
std::string dump_json(const nlohmann::json& value);
/// The same, indented by two spaces, for people.
std::string dump_json_pretty(const nlohmann::json& value);

}  // namespace asip::model
