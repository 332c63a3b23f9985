// SPDX-License-Identifier: Apache-2.0
#include "cli/text/width.hpp"

#include <utf8proc.h>

#include <algorithm>

namespace asip::cli {
namespace {

struct Character {
    utf8proc_int32_t code = 0;
    std::size_t bytes = 1;
    bool valid = true;
};

Character next_character(std::string_view text) {
    Character result;
    const auto* bytes = reinterpret_cast<const utf8proc_uint8_t*>(text.data());
    const auto read = utf8proc_iterate(bytes, static_cast<utf8proc_ssize_t>(text.size()), &result.code);
    if (read <= 0) return {0, 1, false};
    result.bytes = static_cast<std::size_t>(read);
    return result;
}

/// Turns the direction of what follows.
bool changes_direction(utf8proc_int32_t code) {
    switch (utf8proc_get_property(code)->bidi_class) {
        case UTF8PROC_BIDI_CLASS_LRE:
        case UTF8PROC_BIDI_CLASS_LRO:
        case UTF8PROC_BIDI_CLASS_RLE:
        case UTF8PROC_BIDI_CLASS_RLO:
        case UTF8PROC_BIDI_CLASS_PDF:
        case UTF8PROC_BIDI_CLASS_LRI:
        case UTF8PROC_BIDI_CLASS_RLI:
        case UTF8PROC_BIDI_CLASS_FSI:
        case UTF8PROC_BIDI_CLASS_PDI:
            return true;
        default:
            return false;
    }
}

bool is_harmless(const Character& character) {
    return character.valid && utf8proc_category(character.code) != UTF8PROC_CATEGORY_CC &&
           !changes_direction(character.code);
}

std::size_t width_of(const Character& character) {
    if (!character.valid) return 1;
    return static_cast<std::size_t>(std::max(0, utf8proc_charwidth(character.code)));
}

}  // namespace

bool is_plain(std::string_view text) {
    return std::all_of(text.begin(), text.end(), [](char c) { return c >= 0x20 && c < 0x7F; });
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

std::string for_terminal(std::string_view text) {
    std::string result;
    result.reserve(text.size());
    while (!text.empty()) {
        const auto character = next_character(text);
        result += is_harmless(character) ? text.substr(0, character.bytes) : std::string_view("?");
        text.remove_prefix(character.bytes);
    }
    return result;
}

}  // namespace asip::cli
