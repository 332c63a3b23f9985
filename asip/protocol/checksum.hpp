// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "asip/expected.hpp"

namespace asip::protocol {

/// The checksum of extension C: exclusive or of all bytes. It finds any single damaged byte, but neither two
/// equal changes nor bytes that change places.
std::uint8_t checksum(std::string_view text);

/// `I,d,13,1` -> `I,d,13,1*HH`, with two upper-case hexadecimal digits. `line` has no line end.
std::string append_checksum(std::string_view line);

/// The line without its `*HH`, as a view into it. `line` has no line end. Fails when the checksum is missing,
/// is not hexadecimal or does not match.
Expected<std::string_view> verify_checksum(std::string_view line);

}  // namespace asip::protocol
