// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

namespace asip::protocol {

// Bounds of what is read and sent. Everything beyond is refused or counted and dropped, never cut.

/// Without line end. A port map of a 70-pin Mega is about 500 bytes.
inline constexpr std::size_t kMaxBoardLineBytes = 1024;

/// Without newline.
inline constexpr std::size_t kMaxRequestBytes = 250;

/// Without extension L: 62 bytes and a line end of two fit the 64-byte receive buffer of an Arduino.
inline constexpr std::size_t kUsualRequestBytes = 62;

/// In one control payload.
inline constexpr std::size_t kMaxRequestsPerPayload = 64;
inline constexpr std::size_t kMaxPayloadBytes = kMaxRequestsPerPayload * (kUsualRequestBytes + 2);

/// Pins of a board; items of a body.
inline constexpr std::size_t kMaxPins = 256;
inline constexpr std::size_t kMaxBodyItems = 256;

/// Where every board starts.
inline constexpr int kDefaultBaud = 57600;

}  // namespace asip::protocol
