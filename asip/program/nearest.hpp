#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace asip::program {

/// How many insertions, deletions, substitutions and swaps of neighbours turn `a` into `b`. Cases differ by
/// nothing.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate that was probably meant by `word`, or nothing when none is near (distance at most a third of
/// the word's length, and at least 1). The first of equals.
std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& candidates);

/// " (did you mean \"uno1\"?)", or nothing: to be put behind an error.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace asip::program
