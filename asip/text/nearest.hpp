#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace asip::text {

/// Number of insertions, deletions, substitutions and swaps of neighbours that turn `a` into `b`. Upper and
/// lower case are equal. Only the first 128 bytes of each are compared.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// How far a candidate is from `word`; nothing when it is too far to be a misspelling: more edits than a
/// third of the word's bytes (rounded up, at least 1). A candidate that begins with a word of three or more
/// bytes is as near as one edit.
std::optional<std::size_t> misspelling_distance(std::string_view word, std::string_view candidate);

/// The candidate that was probably meant by `word`, or nothing when none is near. The first of equals.
template <class Range>
std::optional<std::string> nearest(std::string_view word, const Range& candidates) {
    std::optional<std::string> found;
    std::size_t best = 0;
    for (const auto& candidate : candidates) {
        const auto distance = misspelling_distance(word, candidate);
        if (!distance || (found && *distance >= best)) continue;
        best = *distance;
        found = std::string(candidate);
    }
    return found;
}

/// ` (did you mean "uno1"?)`, or nothing when no candidate is near: to be put behind an error.
template <class Range>
std::string did_you_mean(std::string_view word, const Range& candidates) {
    const auto found = nearest(word, candidates);
    return found ? " (did you mean \"" + *found + "\"?)" : std::string{};
}

}  // namespace asip::text
