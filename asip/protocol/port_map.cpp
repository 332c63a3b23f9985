// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/port_map.hpp"

#include "asip/protocol/body.hpp"

namespace asip::protocol {
namespace {

constexpr std::int64_t kMaxPort = 255;

Expected<int> parse_port(std::string_view text) {
    const auto port = parse_integer(text);
    if (!port || *port < 0 || *port > kMaxPort) return fail("port is not a number from 0 to 255");
    return static_cast<int>(*port);
}

}  // namespace

Expected<PortState> parse_port_state(std::string_view body) {
    const auto fields = split_fields(body, ',');
    if (fields.size() != 2) return fail("digital event is not PORT,HEXMASK");
    const auto port = parse_port(fields[0]);
    if (!port) return fail(port.error());
    const auto levels = parse_hex(fields[1]);
    if (!levels) return fail("digital event has no hexadecimal mask");
    return PortState{*port, *levels};
}

Expected<PortMap> PortMap::parse(std::string_view body) {
    const auto parsed = parse_body(body);
    if (!parsed) return fail(parsed.error());
    std::vector<Position> positions;
    positions.reserve(parsed->items.size());
    for (const auto item : parsed->items) {
        const auto fields = split_fields(item);
        if (fields.size() != 2) return fail("port map item is not PORT:HEXMASK");
        const auto port = parse_port(fields[0]);
        if (!port) return fail(port.error());
        const auto mask = parse_hex(fields[1]);
        if (!mask) return fail("port map item has no hexadecimal mask");
        positions.push_back({*port, *mask});
    }
    return PortMap(std::move(positions));
}

std::vector<PinLevel> PortMap::levels(const PortState& state) const {
    std::vector<PinLevel> result;
    for (std::size_t pin = 0; pin < positions_.size(); ++pin) {
        const auto& position = positions_[pin];
        if (position.port != state.port || position.mask == 0) continue;
        result.push_back({static_cast<int>(pin), (state.levels & position.mask) != 0});
    }
    return result;
}

}  // namespace asip::protocol
