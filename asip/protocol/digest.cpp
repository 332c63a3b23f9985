// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/digest.hpp"

namespace asip::protocol {

void Digest::add(std::uint8_t byte) {
    constexpr std::uint16_t kPolynomial = 0x8408;
    value_ = static_cast<std::uint16_t>(value_ ^ byte);
    for (int bit = 0; bit < 8; ++bit)
        value_ = static_cast<std::uint16_t>(value_ & 1 ? value_ >> 1 ^ kPolynomial : value_ >> 1);
}

void Digest::add(std::string_view line, int error) {
    for (const char c : line)
        add(static_cast<std::uint8_t>(c));
    add(std::uint8_t{0});
    value_ = static_cast<std::uint16_t>(value_ ^ error);
}

}  // namespace asip::protocol
