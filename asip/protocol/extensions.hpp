// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asip/expected.hpp"

namespace asip::protocol {

// The tags of the link extensions of this protocol.
inline constexpr char kEcho = 'E';           ///< `#,E,TOKEN` comes back as it was sent: proof of execution
inline constexpr char kIdentity = 'I';       ///< a name kept in EEPROM
inline constexpr char kLineRate = 'B';       ///< the rate of the serial line can be changed
inline constexpr char kChecksum = 'C';       ///< lines with `*HH` at their end
inline constexpr char kVerifiedFence = 'V';  ///< fences are answered with a digest of the requests
inline constexpr char kLevels = 'D';         ///< `I,L`: the levels of all input pins, at once
inline constexpr char kRequestLength = 'L';  ///< its "version" is the longest request in bytes
inline constexpr char kFirmware = 'F';       ///< its "version" is that of the firmware, see version_text()

/// The answer to `#,X`: tags and versions (0 to 255). Empty for a 0.4 board.
struct Extensions {
    std::vector<std::pair<char, int>> list;

    /// 0: the board does not have it.
    int version(char tag) const;
    bool has(char tag) const { return version(tag) > 0; }
    bool empty() const { return list.empty(); }
    /// Without newline and checksum: kUsualRequestBytes to kMaxRequestBytes.
    std::size_t longest_request() const;
    friend bool operator==(const Extensions&, const Extensions&) = default;
};

/// A version of the firmware as people read it: 2 is "0.2", 103 is "1.3".
std::string version_text(int version);

/// `4,{E:1,I:1,B:1,C:1}`. Fails on a damaged body.
Expected<Extensions> parse_extensions(std::string_view body);

}  // namespace asip::protocol
