// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

namespace asip::sim {

/// What a receiver makes of one frame.
struct GarbledByte {
    std::uint8_t byte;
    bool framing_error;  ///< its stop bit was low
};

/// Whether a receiver at one rate understands a sender at the other: within 3 %.
bool rates_match(double sender_bit, double receiver_bit);

/// What an 8N1 receiver receives of one 8N1 byte followed by silence, when the bits of both differ in length
/// (any common unit): none, one or several bytes, as on a real line.
std::vector<GarbledByte> receive_frame(std::uint8_t byte, double sender_bit, double receiver_bit);

}  // namespace asip::sim
