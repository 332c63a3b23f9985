// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "asip/expected.hpp"

namespace asip::client {

/// Where a board is, as one line of text that a program can take from its user:
///
///     serial:/dev/ttyACM0            a port of this machine; the path alone ("/dev/ttyACM0") means the same
///     tcp://192.168.1.7:6789         plain ASIP lines over TCP (asip-agent --listen, a board with a network)
///     mqtt://broker:1883/uno1        a board by its name, through a broker (mqtts:// with TLS, port 8883)
///     uno1                           a board by its name, through the broker on this machine
struct Address {
    enum class Kind { kSerial, kTcp, kMqtt };

    Kind kind = Kind::kSerial;
    std::string path;        ///< kSerial: the device
    std::string host;        ///< kTcp, kMqtt
    std::uint16_t port = 0;  ///< kTcp, kMqtt
    bool tls = false;        ///< kMqtt
    /// kMqtt: mqtt://user@broker/uno1. A password has no place here: it would be seen by all users of a
    /// machine.
    std::string user;
    std::string board;  ///< kMqtt: a valid board name
};

/// Fails with a sentence that names the part of `text` that is wrong and what it should look like. Nothing is
/// looked up or opened.
Expected<Address> parse_address(std::string_view text);

}  // namespace asip::client
