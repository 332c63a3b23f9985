// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace asip::text {

/// Insertions, deletions, substitutions and swaps of neighbours from `a` to `b`, without case, of the first
/// 128 bytes of each.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// Nothing: more edits than a third of the word's bytes (rounded up, at least 1). A candidate that begins
/// with a word of three or more bytes is as near as one edit.
std::optional<std::size_t> misspelling_distance(std::string_view word, std::string_view candidate);

/// Pairs of letters looked at for a suggestion: about a millisecond.
inline constexpr std::size_t kMaxPairs = std::size_t{1} << 17;

/// The first of the nearest; nothing: none is near. Those beyond kMaxPairs are not looked at.
template <class Range>
std::optional<std::string> nearest(std::string_view word, const Range& candidates) {
    std::optional<std::string> found;
    std::size_t best = 0;
    std::size_t pairs = 0;
    for (const auto& candidate : candidates) {
        pairs += (word.size() + 1) * (std::string_view(candidate).size() + 1);
        if (pairs > kMaxPairs) break;
        const auto distance = misspelling_distance(word, candidate);
        if (!distance || (found && *distance >= best)) continue;
        best = *distance;
        found = std::string(candidate);
    }
    return found;
}

/// ` (did you mean "uno1"?)`, behind an error; empty: none is near. Give candidates that may be shown.
template <class Range>
std::string did_you_mean(std::string_view word, const Range& candidates) {
    const auto found = nearest(word, candidates);
    return found ? " (did you mean \"" + *found + "\"?)" : std::string{};
}

}  // namespace asip::text
