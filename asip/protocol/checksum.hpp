// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "asip/expected.hpp"

namespace asip::protocol {

/// Extension C: exclusive or of all bytes. It finds a single damaged byte, not two equal changes, nor
/// bytes that change places.
std::uint8_t checksum(std::string_view text);

/// `I,d,13,1` -> `I,d,13,1*HH`. `line` has no line end.
std::string append_checksum(std::string_view line);

/// Without its `*HH`. Fails where that is missing, not hexadecimal or wrong.
Expected<std::string_view> verify_checksum(std::string_view line);

/// What a board with extension V read since its last verified fence: CRC-16/CCITT, reflected, from 0, over
/// each line without line end and checksum, with a zero byte behind it; error numbers change it by exclusive
/// or.
class Digest {
  public:
    /// `error`: 0: executed.
    void add(std::string_view line, int error = 0);
    std::uint16_t value() const { return value_; }

  private:
    void add(std::uint8_t byte);

    std::uint16_t value_ = 0;
};

}  // namespace asip::protocol
