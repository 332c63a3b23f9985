// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <string>
#include <string_view>

#include "asip/expected.hpp"

namespace asip::text {

/// Reads `500ms`, `10s`, `15m`, `12h`, `7d`, or a number of seconds without a unit; fractions such as `1.5h`
/// are allowed. The one reader of durations for all programs. The result is from 0 to 100 years, rounded to
/// whole milliseconds. Fails for anything else: a negative number, an unknown unit, blanks, nothing at all.
/// The reason is a sentence that names the text and the forms.
Expected<std::chrono::milliseconds> parse_duration(std::string_view text);

/// `0.42 ms`, `12 ms`, `3.1 s`, `4 min`, `2 h`, `9 d`: two or three digits and the unit that suits them;
/// `over 100 years` for what is longer, or no number. For a person only; parse_duration() does not read it.
std::string duration_text(std::chrono::duration<double> duration);

}  // namespace asip::text
