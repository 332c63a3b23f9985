// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/checksum.hpp"

#include "asip/protocol/body.hpp"

namespace asip::protocol {

std::uint8_t checksum(std::string_view text) {
    std::uint8_t sum = 0;
    for (const char c : text)
        sum = static_cast<std::uint8_t>(sum ^ static_cast<std::uint8_t>(c));
    return sum;
}

std::string append_checksum(std::string_view line) {
    static constexpr std::string_view kDigits = "0123456789ABCDEF";
    const auto sum = checksum(line);
    std::string result(line);
    result += '*';
    result += kDigits[sum >> 4];
    result += kDigits[sum & 0xf];
    return result;
}

Expected<std::string_view> verify_checksum(std::string_view line) {
    if (line.size() < 3 || line[line.size() - 3] != '*') return fail("line has no checksum");
    const auto text = line.substr(0, line.size() - 3);
    const auto sum = parse_hex(line.substr(line.size() - 2));
    if (!sum) return fail("checksum is not hexadecimal");
    if (*sum != checksum(text)) return fail("checksum does not match");
    return text;
}

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
