// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"

namespace asip::protocol {

/// A counted body `COUNT,{a,b,...}` of any firmware generation: the comma before the brace may be missing, a
/// comma may trail the last item. Items may be empty.
struct Body {
    /// Not split at `:`. Views into the text that was parsed, valid as long as that text.
    std::vector<std::string_view> items;
};

/// Fails when a brace is missing or within the braces, when COUNT is not a number or differs from the number
/// of items (a damaged line), or when there are more than kMaxBodyItems (256).
Expected<Body> parse_body(std::string_view body);

/// `3000:11` -> {"3000", "11"}. An item without `:` is one field; fields may be empty. Views into `item`.
std::vector<std::string_view> split_fields(std::string_view item, char separator = ':');

/// The whole text as a decimal number, a sign allowed. Nothing for an empty text, blanks, other characters or
/// a number that does not fit.
std::optional<std::int64_t> parse_integer(std::string_view text);
/// The same for hexadecimal digits of either case, without a sign and without `0x`.
std::optional<std::uint32_t> parse_hex(std::string_view text);

/// As find_first_of(), for a few characters: it looks for one after the other, several times as fast.
inline std::size_t find_any(std::string_view text, std::string_view few, std::size_t from = 0) {
    auto first = std::string_view::npos;
    for (const char c : few)
        if (const auto at = text.substr(0, first).find(c, from); at != std::string_view::npos) first = at;
    return first;
}

}  // namespace asip::protocol
