// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

namespace asip::protocol {

// Bounds of what is read and sent. Everything beyond is refused or counted and dropped, never cut.

/// Longest line accepted from a board, without its line end. A port map of a 70-pin Mega is about 500 bytes.
inline constexpr std::size_t kMaxBoardLineBytes = 1024;

/// Longest request that any board takes, without its newline.
inline constexpr std::size_t kMaxRequestBytes = 250;

/// The same for a board that does not name a longer one (extension L): 62 bytes, CR LF or a newline and a NUL
/// fit the 64-byte receive buffer of an Arduino.
inline constexpr std::size_t kUsualRequestBytes = 62;

/// Maximum number of request lines in one control payload, and the maximum size of that payload in bytes.
inline constexpr std::size_t kMaxRequestsPerPayload = 64;
inline constexpr std::size_t kMaxPayloadBytes = kMaxRequestsPerPayload * (kUsualRequestBytes + 2);

/// Maximum number of pins that a board may claim, and of items in one body.
inline constexpr std::size_t kMaxPins = 256;
inline constexpr std::size_t kMaxBodyItems = 256;

/// The rate at which every board starts.
inline constexpr int kDefaultBaud = 57600;

}  // namespace asip::protocol
