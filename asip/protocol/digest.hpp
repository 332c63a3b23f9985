// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string_view>

namespace asip::protocol {

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
