// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <string_view>

namespace asip::protocol {

// Requests without a line end, as published clients send them. ASIP 0.4 boards execute a request when its
// last number ends: at the letter of the next request, or after a second of silence.

/// After so long without a byte a request without line end is complete.
inline constexpr auto kRequestSilence = std::chrono::seconds(1);

/// A letter and a comma behind the first request; npos: none. Requests with text (system, display) end at
/// line ends only.
std::size_t next_request(std::string_view text);

/// `text` has as many numbers as the tag of a published service needs; for others it ends in a number or a
/// brace. Half a request never is whole, unless it is cut in its last number.
bool is_whole_request(std::string_view text);

/// When nothing more came: half of a name looks whole, so of the system only questions are.
bool is_whole_after_silence(std::string_view text);

}  // namespace asip::protocol
