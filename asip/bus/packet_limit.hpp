// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

namespace asip::bus {

/// `max_packet_size` of the brokers that we configure. The longest messages are the lists of properties, of
/// 128 KiB; what a gateway exports of the largest boards we know has as much, and pages of registries are cut
/// to it. The larger one message may be, the longer all others wait behind it, and behind its copies.
inline constexpr std::size_t kBrokerPacketBytes = std::size_t{256} * 1024;

}  // namespace asip::bus
