// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace asip::text {

/// The number of insertions, deletions, substitutions and swaps of neighbours that turn `a` into `b`. Upper
/// and lower case are equal. Bytes are compared, not characters, and only the first 128 of each text.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// How many edits a candidate is away from `word`; nothing when it is too far to be a misspelling: more edits
/// than a third of the word's bytes (rounded up, at least 1). A candidate that begins with a word of three or
/// more bytes is as near as one edit.
std::optional<std::size_t> misspelling_distance(std::string_view word, std::string_view candidate);

/// How many pairs of letters are looked at for a suggestion: some hundred usual names. It costs about a
/// millisecond.
inline constexpr std::size_t kMaxPairs = std::size_t{1} << 17;

/// The candidate that was probably meant by `word`, or nothing when none is near. Of several that are equally
/// near, the first. Those beyond kMaxPairs are not looked at. `candidates` is any range of strings or string
/// views.
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

/// ` (did you mean "uno1"?)`, to be put behind an error; an empty text when no candidate is near. The
/// candidate is not escaped: give names that may be shown.
template <class Range>
std::string did_you_mean(std::string_view word, const Range& candidates) {
    const auto found = nearest(word, candidates);
    return found ? " (did you mean \"" + *found + "\"?)" : std::string{};
}

}  // namespace asip::text
