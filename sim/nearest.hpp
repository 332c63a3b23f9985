#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace asip::sim {

/// The candidate that `word` was probably meant to be; empty if none is near.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

/// " (did you mean led?)" or nothing.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace asip::sim
