// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <string>
#include <string_view>

#include "asip/expected.hpp"

namespace asip::text {

/// `500ms`, `10s`, `15m`, `12h`, `7d`, or seconds without a unit, with fractions: 0 to 100 years, rounded to
/// milliseconds. Fails with a sentence that names the text and the forms.
Expected<std::chrono::milliseconds> parse_duration(std::string_view text);

/// `0.42 ms`, `12 ms`, `3.1 s`, `4 min`, `2 h`, `9 d`, or `over 100 years`. For a person only.
std::string duration_text(std::chrono::duration<double> duration);

}  // namespace asip::text
