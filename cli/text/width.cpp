#include "cli/text/width.hpp"

#include <array>
#include <cstdint>

namespace asip::cli {
namespace {

struct Character {
    std::uint32_t code = 0;
    std::size_t bytes = 1;
    bool valid = true;
};

Character next_character(std::string_view text) {
    const auto first = static_cast<unsigned char>(text[0]);
    if (first < 0x80) return {first, 1, true};
    const std::size_t bytes = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
    if (first < 0xC2 || first > 0xF4 || text.size() < bytes) return {first, 1, false};
    std::uint32_t code = first & (0xFFU >> (bytes + 1));
    for (std::size_t i = 1; i < bytes; ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        if ((byte & 0xC0U) != 0x80U) return {first, 1, false};
        code = code << 6U | (byte & 0x3FU);
    }
    return {code, bytes, true};
}

struct Range {
    std::uint32_t first;
    std::uint32_t last;
};

constexpr std::array<Range, 6> kZeroWidth{{{0x0300, 0x036F},
                                           {0x1AB0, 0x1AFF},
                                           {0x200B, 0x200F},
                                           {0x20D0, 0x20FF},
                                           {0xFE00, 0xFE0F},
                                           {0xFE20, 0xFE2F}}};
constexpr std::array<Range, 9> kWide{{{0x1100, 0x115F},
                                      {0x2E80, 0x303E},
                                      {0x3041, 0xA4CF},
                                      {0xAC00, 0xD7A3},
                                      {0xF900, 0xFAFF},
                                      {0xFE30, 0xFE6F},
                                      {0xFF00, 0xFF60},
                                      {0x1F300, 0x1FAFF},
                                      {0x20000, 0x3FFFD}}};

template <std::size_t N>
bool within(const std::array<Range, N>& ranges, std::uint32_t code) {
    for (const auto& range : ranges) {
        if (code >= range.first && code <= range.last) return true;
    }
    return false;
}

bool is_control(const Character& character) {
    return character.valid && (character.code < 0x20 || (character.code >= 0x7F && character.code < 0xA0) ||
                               (character.code >= 0x202A && character.code <= 0x202E) ||
                               (character.code >= 0x2066 && character.code <= 0x2069));
}

std::size_t width_of(const Character& character) {
    if (!character.valid) return 1;
    if (is_control(character) || within(kZeroWidth, character.code)) return 0;
    return within(kWide, character.code) ? 2 : 1;
}

}  // namespace

bool is_plain(std::string_view text) {
    for (const char c : text) {
        if (c < 0x20 || c >= 0x7F) return false;
    }
    return true;
}

std::size_t display_width(std::string_view text) {
    if (is_plain(text)) return text.size();
    std::size_t width = 0;
    while (!text.empty()) {
        const auto character = next_character(text);
        width += width_of(character);
        text.remove_prefix(character.bytes);
    }
    return width;
}

std::string fit(std::string_view text, std::size_t columns) {
    if (display_width(text) <= columns) return std::string(text);
    if (columns == 0) return {};
    std::size_t used = 0;
    std::size_t bytes = 0;
    while (bytes < text.size()) {
        const auto character = next_character(text.substr(bytes));
        if (used + width_of(character) > columns - 1) break;
        used += width_of(character);
        bytes += character.bytes;
    }
    return std::string(text.substr(0, bytes)) + "…";
}

std::string printable(std::string_view text) {
    std::string result;
    result.reserve(text.size());
    while (!text.empty()) {
        const auto character = next_character(text);
        if (is_control(character) || !character.valid) {
            result += '?';
        } else {
            result += text.substr(0, character.bytes);
        }
        text.remove_prefix(character.bytes);
    }
    return result;
}

}  // namespace asip::cli
