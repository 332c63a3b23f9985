// SPDX-License-Identifier: Apache-2.0
#include "sim/chip/garble.hpp"

#include <cmath>

namespace asip::sim {
namespace {

constexpr int kFrameBits = 10;
constexpr double kTolerance = 0.03;

/// The level of the line at bit `index` of the sender: start bit, eight data bits from the lowest, stop bit,
/// then silence.
bool level(std::uint8_t byte, int index) {
    if (index <= 0) return false;
    if (index >= kFrameBits - 1) return true;
    return ((byte >> (index - 1)) & 1) != 0;
}

}  // namespace

bool rates_match(double sender_bit, double receiver_bit) {
    return std::fabs(sender_bit / receiver_bit - 1) <= kTolerance;
}

std::vector<GarbledByte> receive_frame(std::uint8_t byte, double sender_bit, double receiver_bit) {
    std::vector<GarbledByte> received;
    const auto sample = [&](double time) { return level(byte, static_cast<int>(time / sender_bit)); };
    int edge = 0;  // the sender's bit at whose beginning the receiver sees the line fall
    while (edge < kFrameBits) {
        const double start = edge * sender_bit;
        unsigned value = 0;
        for (int i = 0; i < 8; ++i)
            if (sample(start + (i + 1.5) * receiver_bit)) value |= 1u << i;
        const double stop = start + 9.5 * receiver_bit;
        received.push_back({static_cast<std::uint8_t>(value), !sample(stop)});
        edge = static_cast<int>(stop / sender_bit) + 1;
        while (edge < kFrameBits && !(level(byte, edge - 1) && !level(byte, edge)))
            ++edge;
    }
    return received;
}

}  // namespace asip::sim
