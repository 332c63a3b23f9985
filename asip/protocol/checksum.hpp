#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "asip/expected.hpp"

namespace asip::protocol {

/// Exclusive or of all bytes (extension C).
std::uint8_t checksum(std::string_view text);

/// `I,d,13,1` -> `I,d,13,1*HH`.
std::string append_checksum(std::string_view line);

/// The line without its `*HH`, a view into it; fails when the checksum is missing or does not match.
Expected<std::string_view> verify_checksum(std::string_view line);

}  // namespace asip::protocol
