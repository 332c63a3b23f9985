// SPDX-License-Identifier: Apache-2.0
#include "registry/values/value_blocks.hpp"

#include <bit>
#include <cstdint>

namespace asip::registry {
namespace {

template <class Bits>
void append_bits(std::string& block, Bits bits) {
    for (std::size_t i = 0; i < sizeof(Bits); ++i)
        block += static_cast<char>(static_cast<unsigned char>(bits >> (8 * i)));
}

template <class Bits>
bool take_bits(std::string_view& block, Bits& bits) {
    if (block.size() < sizeof(Bits)) return false;
    bits = 0;
    for (std::size_t i = 0; i < sizeof(Bits); ++i)
        bits |= static_cast<Bits>(static_cast<unsigned char>(block[i])) << (8 * i);
    block.remove_prefix(sizeof(Bits));
    return true;
}

bool is_short(double value) {
    return std::isnan(value) ||
           (std::abs(value) < 1e30 && static_cast<double>(static_cast<float>(value)) == value);
}

}  // namespace

std::string pack_changes(std::span<const Change> changes, Tick begin) {
    std::string block;
    block.reserve(changes.size() * 10);
    for (const auto& change : changes) {
        const bool small = is_short(change.value);
        auto head = (static_cast<std::uint64_t>(change.at - begin) << 1) | (small ? 1U : 0U);
        begin = change.at;
        for (; head >= 0x80; head >>= 7)
            block += static_cast<char>(static_cast<unsigned char>(head | 0x80));
        block += static_cast<char>(head);
        if (small)
            append_bits(block, std::bit_cast<std::uint32_t>(static_cast<float>(change.value)));
        else
            append_bits(block, std::bit_cast<std::uint64_t>(change.value));
    }
    return block;
}

bool unpack_change(std::string_view& block, Tick& at, double& value) {
    std::uint64_t head = 0;
    for (unsigned shift = 0;; shift += 7) {
        if (block.empty() || shift > 56) return false;
        const auto byte = static_cast<unsigned char>(block.front());
        block.remove_prefix(1);
        head |= std::uint64_t{byte & 0x7fU} << shift;
        if (byte < 0x80) break;
    }
    at += static_cast<Tick>(head >> 1);
    if ((head & 1) != 0) {
        std::uint32_t bits = 0;
        if (!take_bits(block, bits)) return false;
        value = std::bit_cast<float>(bits);
        return true;
    }
    std::uint64_t bits = 0;
    if (!take_bits(block, bits)) return false;
    value = std::bit_cast<double>(bits);
    return true;
}

}  // namespace asip::registry
