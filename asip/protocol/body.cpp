// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/body.hpp"

#include <charconv>
#include <string>

#include "asip/protocol/limits.hpp"

namespace asip::protocol {
namespace {

template <class Number>
std::optional<Number> parse_whole(std::string_view text, int base) {
    Number value{};
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value, base);
    if (fault != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace

std::optional<std::int64_t> parse_integer(std::string_view text) {
    if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
    return parse_whole<std::int64_t>(text, 10);
}

std::optional<std::uint32_t> parse_hex(std::string_view text) {
    return parse_whole<std::uint32_t>(text, 16);
}

std::vector<std::string_view> split_fields(std::string_view item, char separator) {
    std::vector<std::string_view> fields;
    for (;;) {
        const auto end = item.find(separator);
        fields.push_back(item.substr(0, end));
        if (end == std::string_view::npos) return fields;
        item.remove_prefix(end + 1);
    }
}

Expected<Body> parse_body(std::string_view body) {
    const auto open = body.find('{');
    if (open == std::string_view::npos) return fail("body has no opening brace");
    if (body.back() != '}') return fail("body has no closing brace");
    auto count_text = body.substr(0, open);
    if (!count_text.empty() && count_text.back() == ',') count_text.remove_suffix(1);
    const auto count = parse_integer(count_text);
    if (!count || *count < 0) return fail("body has no count");
    if (*count > static_cast<std::int64_t>(kMaxBodyItems)) return fail("body counts more than 256 items");

    auto inner = body.substr(open + 1, body.size() - open - 2);
    Body result;
    if (find_any(inner, "{}") != inner.npos) return fail("body has a brace within its braces");
    if (!inner.empty() || *count == 1) result.items = split_fields(inner, ',');
    // Behind the last comma there is an empty item, or nothing.
    if (result.items.size() == static_cast<std::size_t>(*count) + 1 && result.items.back().empty())
        result.items.pop_back();
    if (result.items.size() != static_cast<std::size_t>(*count)) {
        return fail("body counts " + std::to_string(*count) + " items and holds " +
                    std::to_string(result.items.size()));
    }
    return result;
}

}  // namespace asip::protocol
