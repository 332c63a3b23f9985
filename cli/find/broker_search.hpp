// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "asip/mqtt/options.hpp"
#include "asip/time.hpp"

namespace asip::cli {

/// By multicast DNS (RFC 6762), as `_mqtt._tcp` (RFC 6763).
struct AnnouncedBroker {
    std::string name;  ///< as its owner calls it; any text
    mqtt::BrokerAddress address;
    friend bool operator==(const AnnouncedBroker&, const AnnouncedBroker&) = default;
};

/// As a packet.
std::vector<std::uint8_t> broker_question(std::uint16_t id);

/// Each broker once; none: no answer to `id`. `sender`: for brokers that leave their address out. Pure.
std::vector<AnnouncedBroker> announced_brokers(std::span<const std::uint8_t> packet, std::uint16_t id,
                                               const std::string& sender);

/// On each network (IPv4), for `patience` at most, less after the first answer. Blocks. By address, at most
/// 32.
std::vector<AnnouncedBroker> search_brokers(Duration patience);

/// On 127.0.0.1.
bool listens_here(std::uint16_t port);

}  // namespace asip::cli
