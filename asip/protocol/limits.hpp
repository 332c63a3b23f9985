#pragma once
#include <cstddef>

namespace asip::protocol {

/// Longest line accepted from a board, without its line end. A port map of a 70-pin Mega is about 500 bytes.
inline constexpr std::size_t kMaxBoardLineBytes = 1024;

/// Longest request sent to a board, without its newline: 62 bytes, CR LF or a newline and a NUL fit the
/// 64-byte receive buffer of an Arduino.
inline constexpr std::size_t kMaxRequestBytes = 62;

/// Most request lines accepted in one control payload, and the payload's longest size.
inline constexpr std::size_t kMaxRequestsPerPayload = 64;
inline constexpr std::size_t kMaxPayloadBytes = kMaxRequestsPerPayload * (kMaxRequestBytes + 2);

/// Most pins a board may claim, and most items in one body.
inline constexpr std::size_t kMaxPins = 256;
inline constexpr std::size_t kMaxBodyItems = 256;

inline constexpr int kDefaultBaud = 57600;

}  // namespace asip::protocol
