// SPDX-License-Identifier: Apache-2.0
#include "asip/text/printable.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

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

/// The bytes of a character that no one sees, at the beginning; 0: another one is there.
std::size_t unseen_bytes(std::string_view text) {
    if (text.starts_with("\xd8\x9c")) return 2;
    if (text.starts_with("\xef\xbb\xbf")) return 3;
    if (text.size() < 3 || text[0] != '\xe2') return 0;
    const auto second = static_cast<unsigned char>(text[1]);
    const auto third = static_cast<unsigned char>(text[2]);
    const bool unseen =
        (second == 0x80 && ((third >= 0x8b && third <= 0x8f) || (third >= 0xa8 && third <= 0xae))) ||
        (second == 0x81 && third >= 0xa0 && third <= 0xa9);
    return unseen ? 3 : 0;
}

}  // namespace

std::string printable(std::string_view text, std::size_t max_bytes) {
    std::string result;
    for (const char c : text.substr(0, max_bytes))
        if (c >= 0x20 && c <= 0x7e && c != '\\')
            result += c;
        else
            append_escaped(result, c);
    return text.size() > max_bytes ? result + "..." : result;
}

std::string escape_controls(std::string_view text) {
    std::string result;
    result.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto unseen = is_c1(text, i) ? 2 : is_ascii_control(text[i]) ? 1 : unseen_bytes(text.substr(i));
        if (unseen == 0) {
            result += text[i];
            continue;
        }
        for (const char c : text.substr(i, unseen))
            append_escaped(result, c);
        i += unseen - 1;
    }
    return result;
}

std::string escape_json(std::string document) {
    const auto plain = [](char c) { return static_cast<unsigned char>(c) < 0x7f; };
    const auto first = std::find_if_not(document.begin(), document.end(), plain);
    if (first == document.end()) return document;
    const std::string_view text = document;
    auto i = static_cast<std::size_t>(first - document.begin());
    std::string result(text.substr(0, i));
    while (i < text.size()) {
        const auto byte = [&](std::size_t at) { return static_cast<unsigned>(text[i + at]) & 0x3fU; };
        std::size_t length = 1;
        unsigned character = 0x7f;
        if (is_c1(text, i)) {
            length = 2;
            character = 0x80U | byte(1);
        } else if (const auto unseen = unseen_bytes(text.substr(i)); unseen == 2) {
            length = 2;
            character = (static_cast<unsigned>(text[i]) & 0x1fU) << 6U | byte(1);
        } else if (unseen == 3) {
            length = 3;
            character = (static_cast<unsigned>(text[i]) & 0xfU) << 12U | byte(1) << 6U | byte(2);
        } else if (text[i] != '\x7f') {
            result += text[i++];
            continue;
        }
        std::array<char, 12> escaped{};
        std::snprintf(escaped.data(), escaped.size(), "\\u%04x", character);
        result += escaped.data();
        i += length;
    }
    return result;
}

std::string without_credentials(std::string_view address) {
    const auto at = address.rfind('@');
    if (at == std::string_view::npos) return std::string(address);
    const auto scheme = address.substr(0, at).find("://");
    const auto kept = scheme == std::string_view::npos ? std::string_view() : address.substr(0, scheme + 3);
    return std::string(kept) + "..." + std::string(address.substr(at));
}

bool is_showable(std::string_view text) {
    for (std::size_t i = 0; i < text.size(); ++i)
        if (is_ascii_control(text[i]) || is_c1(text, i)) return false;
    return true;
}

bool begins_unseen(std::string_view text) {
    return unseen_bytes(text) > 0;
}

}  // namespace asip::text
