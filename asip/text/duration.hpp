#pragma once
#include <chrono>
#include <string>
#include <string_view>

#include "asip/expected.hpp"

namespace asip::text {

/// `500ms`, `10s`, `15m`, `12h`, `7d`, or a number of seconds; fractions are allowed. From 0 to 100 years, in
/// whole milliseconds. Error: a sentence that names the text and the forms.
Expected<std::chrono::milliseconds> parse_duration(std::string_view text);

/// `0.42 ms`, `12 ms`, `3.1 s`, `4 min`, `2 h`, `9 d`: as coarse as a person needs.
std::string duration_text(std::chrono::duration<double> duration);

}  // namespace asip::text
