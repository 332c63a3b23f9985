// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <cstring>
#include <string_view>

namespace asip::catalogue {

struct WideProduct {
    std::uint64_t low;
    std::uint64_t high;
    friend bool operator==(const WideProduct&, const WideProduct&) = default;
};

/// Where the machine has no integers of 128 bits: by halves.
constexpr WideProduct multiply_by_halves(std::uint64_t a, std::uint64_t b) {
    constexpr std::uint64_t kHalf = 0xFFFFFFFFu;
    const std::uint64_t low = (a & kHalf) * (b & kHalf);
    const std::uint64_t left = (a >> 32) * (b & kHalf) + (low >> 32);
    const std::uint64_t right = (a & kHalf) * (b >> 32) + (left & kHalf);
    return {(right << 32) | (low & kHalf), (a >> 32) * (b >> 32) + (left >> 32) + (right >> 32)};
}

constexpr WideProduct multiply(std::uint64_t a, std::uint64_t b) {
#ifdef __SIZEOF_INT128__
    __extension__ using Wide = unsigned __int128;
    const Wide product = static_cast<Wide>(a) * b;
    return {static_cast<std::uint64_t>(product), static_cast<std::uint64_t>(product >> 64)};
#else
    return multiply_by_halves(a, b);
#endif
}

/// A hash of bytes that strangers choose: a stranger without the seed cannot pick texts that collide.
inline std::uint64_t hash_bytes(std::string_view text, std::uint64_t seed) {
    const auto mix = [](std::uint64_t a, std::uint64_t b) {
        const auto product = multiply(a, b);
        return product.low ^ product.high;
    };
    std::uint64_t state = seed ^ (text.size() * 0x9E3779B97F4A7C15u);
    const char* at = text.data();
    std::size_t left = text.size();
    while (left >= 16) {
        std::uint64_t a = 0;
        std::uint64_t b = 0;
        std::memcpy(&a, at, 8);
        std::memcpy(&b, at + 8, 8);
        state = mix(a ^ state, b ^ (seed | 1));
        at += 16;
        left -= 16;
    }
    std::uint64_t a = 0;
    std::uint64_t b = 0;
    std::memcpy(&a, at, left < 8 ? left : 8);
    if (left > 8) std::memcpy(&b, at + 8, left - 8);
    state = mix(a ^ state ^ 0xA0761D6478BD642Fu, b ^ seed ^ 0xE7037ED1A0B428DBu);
    return mix(state, 0x8EBC6AF09C88C6E3u);
}

}  // namespace asip::catalogue
