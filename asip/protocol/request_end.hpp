// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <string_view>

namespace asip::protocol {

// Requests without a line end, as published clients send them. ASIP 0.4 boards execute a request when its
// last number ends: at the letter of the next request, or after a second of silence.

/// So long nothing may come until a request without line end is complete.
inline constexpr auto kRequestSilence = std::chrono::seconds(1);

/// Where the next request begins in `text`, with a letter and a comma behind its own service and tag; npos:
/// nowhere. Requests that hold text, those of the system and of a display, end at line ends only.
std::size_t next_request(std::string_view text);

/// Whether `text` is all of a request. Of published services it has as many numbers as its tag needs, of
/// others it ends in a number or a brace. Half of it never is, unless it is cut in its last number.
bool is_whole_request(std::string_view text);

/// The same where nothing more came: half of a name or a token looks whole, so that of the system only
/// questions without any are.
bool is_whole_after_silence(std::string_view text);

}  // namespace asip::protocol
