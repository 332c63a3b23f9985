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
    enum class Kind { Serial, Tcp, Mqtt };

    Kind kind = Kind::Serial;
    std::string path;        ///< Serial: the device.
    std::string host;        ///< Tcp, Mqtt.
    std::uint16_t port = 0;  ///< Tcp, Mqtt.
    bool tls = false;        ///< Mqtt.
    std::string user;        ///< Mqtt: mqtt://user@broker/uno1. There is no place for a password on purpose.
    std::string board;       ///< Mqtt: a valid board name.
};

/// The reason it failed says which part of `text` is wrong and what it should look like.
Expected<Address> parse_address(std::string_view text);

}  // namespace asip::client
