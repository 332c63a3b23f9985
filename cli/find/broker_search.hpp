// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "asip/mqtt/options.hpp"
#include "asip/time.hpp"

namespace asip::cli {

/// A broker that is announced on the local network by multicast DNS (RFC 6762) as `_mqtt._tcp` (RFC 6763).
struct AnnouncedBroker {
    std::string name;  ///< as its owner calls it; any text
    mqtt::BrokerAddress address;
    friend bool operator==(const AnnouncedBroker&, const AnnouncedBroker&) = default;
};

/// The question for them, as a packet.
std::vector<std::uint8_t> broker_question(std::uint16_t id);

/// What an answer to the question with this id announces, each broker once; none where the packet is no such
/// answer. `sender`: address that it came from, for brokers whose own it leaves out. Pure.
std::vector<AnnouncedBroker> announced_brokers(std::span<const std::uint8_t> packet, std::uint16_t id,
                                               const std::string& sender);

/// Asks on each network of this machine (IPv4), and collects answers for `patience` at most; a short time
/// after the first one it ends. Blocks. In the order of their addresses, at most 32.
std::vector<AnnouncedBroker> search_brokers(Duration patience);

/// Whether a program listens on this port of 127.0.0.1.
bool listens_here(std::uint16_t port);

}  // namespace asip::cli
