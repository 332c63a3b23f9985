#pragma once
#include <string>
#include <string_view>

namespace asip::model {

inline constexpr std::size_t kMaxNameBytes = 64;
/// What a board can keep in its EEPROM.
inline constexpr std::size_t kMaxStoredNameBytes = 32;

/// 1 to 64 of `A-Z a-z 0-9 . _ -`.
bool valid_name(std::string_view name);

/// valid_name and none of the reserved ones: `servicebus`, `registry`. (`$...` is no valid name anyway.)
bool valid_board_name(std::string_view name);

/// Why valid_board_name refused it, as a sentence part for a person: "'a b' holds a space; allowed are ...".
/// Unprintable bytes are shown escaped. Empty when the name is valid.
std::string explain_board_name(std::string_view name);

/// The nearest valid board name: what is not allowed becomes `-`, runs of it collapse, ends are trimmed,
/// reserved names get `-board` appended; "board" when nothing is left.
std::string suggest_name(std::string_view text);

/// Text fit for a log or a terminal: control characters, the backslash and bytes beyond ASCII as `\\xNN`;
/// what is longer is cut, with `...` behind it.
std::string printable(std::string_view text, std::size_t max_bytes = 80);

/// Whether text that a stranger sent can be shown as it is: it holds no control characters (of ASCII or
/// Latin-1 in UTF-8), so no terminal takes orders from it.
bool is_showable(std::string_view text);

/// The candidate nearest to `word` (edit distance, case ignored) if it is near enough to be a slip; else
/// empty.
template <class Range>
std::string nearest(std::string_view word, const Range& candidates);

/// Number of single-character edits between the two, case ignored.
std::size_t edit_distance(std::string_view a, std::string_view b);

template <class Range>
std::string nearest(std::string_view word, const Range& candidates) {
    std::string best;
    std::size_t best_distance = word.size() < 3 ? 1 : (word.size() + 2) / 3 + 1;
    for (const auto& candidate : candidates) {
        const auto distance = edit_distance(word, candidate);
        if (distance < best_distance) {
            best_distance = distance;
            best = std::string(candidate);
        }
    }
    return best;
}

}  // namespace asip::model
