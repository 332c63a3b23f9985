// SPDX-License-Identifier: Apache-2.0
#include "asip/client/address.hpp"

#include <charconv>
#include <utility>

#include "asip/model/names.hpp"
#include "asip/text/printable.hpp"

namespace asip::client {
namespace {

constexpr std::uint16_t kMqttPort = 1883;
constexpr std::uint16_t kMqttTlsPort = 8883;

bool take_prefix(std::string_view& text, std::string_view prefix) {
    if (text.substr(0, prefix.size()) != prefix) return false;
    text.remove_prefix(prefix.size());
    return true;
}

/// "host", "host:port", "[::1]:port"; `fallback` 0 means that a port must be given.
Expected<std::pair<std::string, std::uint16_t>> parse_host_port(std::string_view text,
                                                                std::uint16_t fallback) {
    std::string_view host = text;
    std::string_view port;
    bool has_port = false;
    if (!text.empty() && text.front() == '[') {
        const auto end = text.find(']');
        if (end == std::string_view::npos)
            return fail("\"" + std::string(text) + "\": the [ of an IPv6 address is never closed");
        host = text.substr(1, end - 1);
        text.remove_prefix(end + 1);
        has_port = take_prefix(text, ":");
        if (!has_port && !text.empty()) return fail("only :PORT may follow the ] of an IPv6 address");
        port = text;
    } else if (const auto colon = text.rfind(':'); colon != std::string_view::npos) {
        if (text.find(':') != colon)
            return fail("\"" + std::string(text) + "\": write an IPv6 address in brackets, [::1]");
        host = text.substr(0, colon);
        port = text.substr(colon + 1);
        has_port = true;
    }
    if (host.empty()) return fail("the host is missing");
    if (!has_port) {
        if (fallback == 0) return fail("\"" + std::string(host) + "\": the port is missing, HOST:PORT");
        return std::pair{std::string(host), fallback};
    }
    std::uint16_t number = 0;
    const auto [end, code] = std::from_chars(port.data(), port.data() + port.size(), number);
    if (code != std::errc{} || end != port.data() + port.size() || number == 0)
        return fail("\"" + std::string(port) + "\" is not a port, 1 to 65535");
    return std::pair{std::string(host), number};
}

Expected<Address> parse_board_name(std::string_view name, Address address) {
    if (!model::valid_board_name(name)) {
        return fail("\"" + text::without_credentials(name) +
                    "\" is not a board name: 1 to 64 of A-Z a-z 0-9 . _ -");
    }
    address.board = name;
    return address;
}

Expected<Address> parse_serial(std::string_view path) {
    if (path.empty()) return fail("the serial port is missing, serial:/dev/ttyACM0");
    Address address;
    address.path = path;
    return address;
}

Expected<Address> parse_tcp(std::string_view rest) {
    auto place = parse_host_port(rest, 0);
    if (!place) return fail(place.error());
    Address address;
    address.kind = Address::Kind::kTcp;
    std::tie(address.host, address.port) = std::move(*place);
    return address;
}

Expected<Address> parse_mqtt(std::string_view rest, bool tls) {
    Address address;
    address.kind = Address::Kind::kMqtt;
    address.tls = tls;
    const auto slash = rest.find('/');
    if (slash == std::string_view::npos || slash + 1 == rest.size())
        return fail("the board's name is missing, mqtt://broker/uno1");
    std::string_view authority = rest.substr(0, slash);
    if (const auto at = authority.rfind('@'); at != std::string_view::npos) {
        const std::string_view user = authority.substr(0, at);
        if (user.find(':') != std::string_view::npos)
            return fail("an address holds no password: put it in a file and name that in the options");
        address.user = user;
        authority.remove_prefix(at + 1);
    }
    auto place = parse_host_port(authority, tls ? kMqttTlsPort : kMqttPort);
    if (!place) return fail(place.error());
    std::tie(address.host, address.port) = std::move(*place);
    return parse_board_name(rest.substr(slash + 1), std::move(address));
}

}  // namespace

Expected<Address> parse_address(std::string_view text) {
    if (text.empty()) {
        return fail(
            "the board's address is empty; for example /dev/ttyACM0, tcp://host:6789 or mqtt://broker/uno1");
    }
    if (text.front() == '/') return parse_serial(text);
    if (take_prefix(text, "serial:")) return parse_serial(text);
    if (take_prefix(text, "tcp://")) return parse_tcp(text);
    if (take_prefix(text, "mqtt://")) return parse_mqtt(text, false);
    if (take_prefix(text, "mqtts://")) return parse_mqtt(text, true);
    if (text.find("://") != std::string_view::npos) {
        return fail("\"" + text::without_credentials(text) +
                    "\": an address begins with serial:, tcp://, mqtt:// or mqtts://");
    }
    Address address;
    address.kind = Address::Kind::kMqtt;
    address.host = "127.0.0.1";
    address.port = kMqttPort;
    return parse_board_name(text, std::move(address));
}

}  // namespace asip::client
