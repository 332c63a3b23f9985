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

/// What a board with extension V says of the requests that it read since its last verified fence:
/// CRC-16/CCITT, reflected, from 0, over each line without line end and checksum, and a zero byte behind it;
/// the number of the error that it answered with changes it by exclusive or.
class Digest {
  public:
    /// `error`: 0 for a request that was executed.
    void add(std::string_view line, int error = 0);
    std::uint16_t value() const { return value_; }

  private:
    void add(std::uint8_t byte);

    std::uint16_t value_ = 0;
};

}  // namespace asip::protocol
