// SPDX-License-Identifier: Apache-2.0
#include "asip/text/printable.hpp"

namespace asip::text {
namespace {

constexpr unsigned char kFirstOfC1InUtf8 = 0xc2;

void append_escaped(std::string& out, char c) {
    static constexpr std::string_view kDigits = "0123456789abcdef";
    const auto byte = static_cast<unsigned char>(c);
    out += "\\x";
    out += kDigits[byte >> 4];
    out += kDigits[byte & 0xf];
}

bool is_ascii_control(char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7f;
}

/// U+0080 to U+009F, which some terminals obey like ESC sequences.
bool is_c1(std::string_view text, std::size_t at) {
    if (at + 1 >= text.size() || static_cast<unsigned char>(text[at]) != kFirstOfC1InUtf8) return false;
    const auto second = static_cast<unsigned char>(text[at + 1]);
    return second >= 0x80 && second <= 0x9f;
}

}  // namespace

std::string printable(std::string_view text, std::size_t max_bytes) {
    std::string result;
    for (const char c : text.substr(0, max_bytes)) {
        if (c >= 0x20 && c <= 0x7e && c != '\\') {
            result += c;
        } else {
            append_escaped(result, c);
        }
    }
    return text.size() > max_bytes ? result + "..." : result;
}

std::string escape_controls(std::string_view text) {
    std::string result;
    result.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (is_c1(text, i)) {
            append_escaped(result, text[i]);
            append_escaped(result, text[++i]);
        } else if (is_ascii_control(text[i])) {
            append_escaped(result, text[i]);
        } else {
            result += text[i];
        }
    }
    return result;
}

bool is_showable(std::string_view text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (is_ascii_control(text[i]) || is_c1(text, i)) return false;
    }
    return true;
}

bool begins_unseen(std::string_view text) {
    if (text.starts_with("\xef\xbb\xbf")) return true;
    if (text.size() < 3 || text[0] != '\xe2') return false;
    const auto second = static_cast<unsigned char>(text[1]);
    const auto third = static_cast<unsigned char>(text[2]);
    return (second == 0x80 && ((third >= 0x8b && third <= 0x8f) || (third >= 0xa8 && third <= 0xae))) ||
           (second == 0x81 && third >= 0xa0 && third <= 0xa9);
}

}  // namespace asip::text
