// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"

namespace asip::protocol {

/// `COUNT,{a,b,...}` of any firmware: the comma before the brace may be missing, one may trail. Items may be
/// empty.
struct Body {
    /// Not split at `:`. Views into the parsed text.
    std::vector<std::string_view> items;
};

/// Fails on missing or nested braces, a wrong COUNT, and more than kMaxBodyItems.
Expected<Body> parse_body(std::string_view body);

/// `3000:11` -> {"3000", "11"}. Fields may be empty. Views into `item`.
std::vector<std::string_view> split_fields(std::string_view item, char separator = ':');

/// A whole decimal number, a sign allowed; nothing: another text, or one that does not fit.
std::optional<std::int64_t> parse_integer(std::string_view text);
/// Either case, without sign and `0x`.
std::optional<std::uint32_t> parse_hex(std::string_view text);

/// As find_first_of(), several times as fast for a few characters.
inline std::size_t find_any(std::string_view text, std::string_view few, std::size_t from = 0) {
    auto first = std::string_view::npos;
    for (const char c : few)
        if (const auto at = text.substr(0, first).find(c, from); at != std::string_view::npos) first = at;
    return first;
}

}  // namespace asip::protocol
