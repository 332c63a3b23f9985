// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

namespace asip::sim {

/// From one frame.
struct GarbledByte {
    std::uint8_t byte;
    bool framing_error;  ///< its stop bit was low
};

/// Within 3 %.
bool rates_match(double sender_bit, double receiver_bit);

/// What a receiver makes of one 8N1 byte and silence, when bits differ in length: none, one or several bytes.
std::vector<GarbledByte> receive_frame(std::uint8_t byte, double sender_bit, double receiver_bit);

}  // namespace asip::sim
