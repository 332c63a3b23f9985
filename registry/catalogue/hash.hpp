// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <cstring>
#include <string_view>

namespace asip::registry {

/// A hash of bytes that strangers choose: who does not know the seed cannot pick texts that collide.
inline std::uint64_t hash_bytes(std::string_view text, std::uint64_t seed) {
    const auto mix = [](std::uint64_t a, std::uint64_t b) {
        __extension__ using Wide = unsigned __int128;
        const Wide product = static_cast<Wide>(a) * b;
        return static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64);
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

}  // namespace asip::registry
