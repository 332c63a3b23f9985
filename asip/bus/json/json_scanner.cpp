// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/json/json_scanner.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

namespace asip::bus {
namespace {

// 0: part of a string as it is, 1: ends the fast loop (quote, backslash, control character, first byte of
// UTF-8)
constexpr std::array<std::uint8_t, 256> make_special() {
    std::array<std::uint8_t, 256> table{};
    for (int c = 0; c < 0x20; ++c)
        table[static_cast<std::size_t>(c)] = 1;
    for (int c = 0x80; c < 0x100; ++c)
        table[static_cast<std::size_t>(c)] = 1;
    table['"'] = 1;
    table['\\'] = 1;
    return table;
}
constexpr auto kSpecial = make_special();

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}
bool is_hex(char c) {
    return is_digit(c) || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
}
std::uint8_t byte(char c) {
    return static_cast<std::uint8_t>(c);
}

}  // namespace

void JsonScanner::space() {
    while (at_ != end_ && (*at_ == ' ' || *at_ == '\n' || *at_ == '\r' || *at_ == '\t'))
        ++at_;
}

bool JsonScanner::enter(char open) {
    space();
    if (at_ == end_ || *at_ != open) return false;
    ++at_;
    first_ = true;
    left_ = false;
    return true;
}

bool JsonScanner::enter_object() {
    return enter('{');
}
bool JsonScanner::enter_array() {
    return enter('[');
}
bool JsonScanner::next_element() {
    return next(']');
}

bool JsonScanner::next(char close) {
    left_ = false;
    space();
    if (at_ == end_) return false;
    if (*at_ == close) {
        ++at_;
        left_ = true;
        first_ = false;  // of the container around it, which has at least this one
        return false;
    }
    if (!first_) {
        if (*at_ != ',') return false;
        ++at_;
        space();
    }
    first_ = false;
    return true;
}

bool JsonScanner::next_member(std::string_view& key) {
    if (!next('}')) return false;
    const char* begin = at_;
    if (at_ == end_ || *at_ != '"' || !skip_string()) return false;
    key = raw_key_ = std::string_view(begin + 1, static_cast<std::size_t>(at_ - begin - 2));
    if (escaped_) {
        const auto text = nlohmann::json::parse(begin, at_, nullptr, false);
        if (!text.is_string()) return false;
        key = unescaped_key_ = text.get<std::string>();
    }
    space();
    if (at_ == end_ || *at_ != ':') return false;
    ++at_;
    space();
    return true;
}

bool JsonScanner::value(std::string_view& raw) {
    space();
    const char* begin = at_;
    if (!skip_value(1)) return false;
    raw = std::string_view(begin, static_cast<std::size_t>(at_ - begin));
    return true;
}

bool JsonScanner::known_value(std::string_view text) {
    const auto left = static_cast<std::size_t>(end_ - at_);
    // All texts compared here end with a quote, a brace or a bracket: no value goes on behind it.
    if (text.empty() || text.size() > left || std::memcmp(at_, text.data(), text.size()) != 0) return false;
    at_ += text.size();
    return true;
}

bool JsonScanner::known_rest(std::string_view text) {
    if (!known_value(text)) return false;
    left_ = true;
    first_ = false;
    return true;
}

bool JsonScanner::plain_string(std::string_view& text) {
    if (at_ == end_ || *at_ != '"') return false;
    const char* p = at_ + 1;
    while (p != end_ && kSpecial[byte(*p)] == 0)
        ++p;
    if (p == end_ || *p != '"') return false;
    text = std::string_view(at_ + 1, static_cast<std::size_t>(p - at_ - 1));
    at_ = p + 1;
    return true;
}

bool JsonScanner::unsigned_integer(std::uint64_t& number) {
    const char* p = at_;
    std::uint64_t result = 0;
    while (p != end_ && is_digit(*p) && p - at_ < 19)
        result = result * 10 + static_cast<std::uint64_t>(*p++ - '0');
    if (p == at_ || (*at_ == '0' && p - at_ > 1)) return false;
    if (p != end_ && (is_digit(*p) || *p == '.' || *p == 'e' || *p == 'E')) return false;
    number = result;
    at_ = p;
    return true;
}

bool JsonScanner::at_end() {
    space();
    return at_ == end_;
}

bool JsonScanner::skip_value(int depth) {
    if (at_ == end_) return false;
    switch (*at_) {
        case '"':
            return skip_string();
        case '{':
            return depth <= kMaxDepth && skip_container('}', depth);
        case '[':
            return depth <= kMaxDepth && skip_container(']', depth);
        case 't':
            return skip_literal("true");
        case 'f':
            return skip_literal("false");
        case 'n':
            return skip_literal("null");
        default:
            return skip_number();
    }
}

bool JsonScanner::skip_container(char close, int depth) {
    ++at_;
    space();
    if (at_ != end_ && *at_ == close) {
        ++at_;
        return true;
    }
    for (;;) {
        space();
        if (close == '}') {
            if (at_ == end_ || *at_ != '"' || !skip_string()) return false;
            space();
            if (at_ == end_ || *at_ != ':') return false;
            ++at_;
            space();
        }
        if (!skip_value(depth + 1)) return false;
        space();
        if (at_ == end_) return false;
        const char c = *at_++;
        if (c == close) return true;
        if (c != ',') return false;
    }
}

bool JsonScanner::skip_string() {
    ++at_;
    escaped_ = false;
    for (;;) {
        while (at_ != end_ && kSpecial[byte(*at_)] == 0)
            ++at_;
        if (at_ == end_ || byte(*at_) < 0x20) return false;
        if (*at_ == '"') {
            ++at_;
            return true;
        }
        if (*at_ != '\\') {
            if (!skip_utf8()) return false;
            continue;
        }
        if (end_ - at_ < 2) return false;
        escaped_ = true;
        const char escaped = at_[1];
        if (escaped == 'u') {
            if (end_ - at_ < 6) return false;
            for (int i = 2; i < 6; ++i)
                if (!is_hex(at_[i])) return false;
            // A surrogate must come as a pair, or parsers that make UTF-8 of it refuse the text.
            const bool high = (at_[2] == 'd' || at_[2] == 'D') && std::strchr("89abAB", at_[3]) != nullptr;
            const bool low = (at_[2] == 'd' || at_[2] == 'D') && std::strchr("cdefCDEF", at_[3]) != nullptr;
            if (low) return false;
            at_ += 6;
            if (high) {
                if (end_ - at_ < 6 || at_[0] != '\\' || at_[1] != 'u' || (at_[2] != 'd' && at_[2] != 'D') ||
                    std::strchr("cdefCDEF", at_[3]) == nullptr || at_[3] == '\0' || !is_hex(at_[4]) ||
                    !is_hex(at_[5])) {
                    return false;
                }
                at_ += 6;
            }
        } else {
            if (escaped == '\0' || std::strchr("\"\\/bfnrt", escaped) == nullptr) return false;
            at_ += 2;
        }
    }
}

bool JsonScanner::skip_utf8() {
    const auto left = end_ - at_;
    const std::uint8_t lead = byte(*at_);
    int length = 0;
    std::uint8_t low = 0x80;
    std::uint8_t high = 0xBF;
    if (lead >= 0xC2 && lead <= 0xDF) {
        length = 2;
    } else if (lead >= 0xE0 && lead <= 0xEF) {
        length = 3;
        if (lead == 0xE0) low = 0xA0;   // overlong
        if (lead == 0xED) high = 0x9F;  // surrogates
    } else if (lead >= 0xF0 && lead <= 0xF4) {
        length = 4;
        if (lead == 0xF0) low = 0x90;
        if (lead == 0xF4) high = 0x8F;  // above U+10FFFF
    } else {
        return false;
    }
    if (left < length || byte(at_[1]) < low || byte(at_[1]) > high) return false;
    for (int i = 2; i < length; ++i)
        if ((byte(at_[i]) & 0xC0) != 0x80) return false;
    at_ += length;
    return true;
}

bool JsonScanner::skip_number() {
    const char* p = at_;
    if (p != end_ && *p == '-') ++p;
    if (p == end_ || !is_digit(*p)) return false;
    if (*p == '0')
        ++p;
    else
        while (p != end_ && is_digit(*p))
            ++p;
    if (p != end_ && *p == '.') {
        ++p;
        if (p == end_ || !is_digit(*p)) return false;
        while (p != end_ && is_digit(*p))
            ++p;
    }
    const bool scaled = p != end_ && (*p == 'e' || *p == 'E');
    if (scaled) {
        ++p;
        if (p != end_ && (*p == '+' || *p == '-')) ++p;
        if (p == end_ || !is_digit(*p)) return false;
        while (p != end_ && is_digit(*p))
            ++p;
    }
    // Shorter ones without an exponent are always within a double's range. Parsers refuse those beyond it.
    constexpr std::ptrdiff_t kAlwaysFinite = 300;
    const std::string_view number(at_, static_cast<std::size_t>(p - at_));
    if ((scaled || number.size() > kAlwaysFinite) && !is_finite(number)) return false;
    at_ = p;
    return true;
}

bool JsonScanner::is_finite(std::string_view number) {
    double value = 0;
    if (std::from_chars(number.data(), number.data() + number.size(), value).ec == std::errc{})
        return std::isfinite(value);
    // Too small is 0. With what power of ten does it begin?
    if (number.front() == '-') number.remove_prefix(1);
    const auto exponent_at = std::min(number.find_first_of("eE"), number.size());
    const auto mantissa = number.substr(0, exponent_at);
    const auto first = mantissa.find_first_of("123456789");
    if (first == std::string_view::npos) return true;
    const auto point = std::min(mantissa.find('.'), mantissa.size());
    const auto begins = static_cast<std::int64_t>(point) - static_cast<std::int64_t>(first);
    auto exponent = number.substr(std::min(exponent_at + 1, number.size()));
    if (exponent.starts_with('+')) exponent.remove_prefix(1);
    std::int64_t power = 0;
    const auto read = std::from_chars(exponent.data(), exponent.data() + exponent.size(), power);
    if (read.ec == std::errc::result_out_of_range) return exponent.starts_with('-');
    return begins + power < 0;
}

bool JsonScanner::skip_literal(std::string_view word) {
    if (static_cast<std::size_t>(end_ - at_) < word.size() || std::memcmp(at_, word.data(), word.size()) != 0)
        return false;
    at_ += word.size();
    return true;
}

}  // namespace asip::bus
