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

/// Parses text that anyone may have written. Never throws and never recurses deeper than the limit; fails
/// with a reason when the text is too long, too deep, or no JSON (strings must be UTF-8). Duplicate keys: the
/// last one counts.
Expected<nlohmann::json> parse_json(std::string_view text, JsonLimits limits = {});

/// Compact text; bytes that are not UTF-8 become U+FFFD instead of an exception.
std::string dump_json(const nlohmann::json& value);
/// The same, indented by two spaces, for people.
std::string dump_json_pretty(const nlohmann::json& value);

}  // namespace asip::model
