#pragma once
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"

namespace asip::protocol {

/// `COUNT,{a,b,...}` of any firmware generation: the comma before the brace may be missing, a comma may trail
/// the last item. Items are not split at `:` and point into the text that was parsed.
struct Body {
    std::vector<std::string_view> items;
};

/// Fails when a brace is missing, COUNT is not a number or differs from the number of items (a damaged line),
/// or there are more than kMaxBodyItems.
Expected<Body> parse_body(std::string_view body);

/// `3000:11` -> {"3000", "11"}; an item without `:` is one field.
std::vector<std::string_view> split_fields(std::string_view item, char separator = ':');

/// The whole text as a decimal number, a sign allowed; nothing otherwise. parse_hex takes no sign and no 0x.
std::optional<std::int64_t> parse_integer(std::string_view text);
std::optional<std::uint32_t> parse_hex(std::string_view text);

}  // namespace asip::protocol
