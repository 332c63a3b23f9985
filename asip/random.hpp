// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <string>

namespace asip {

/// Where randomness comes from: each call returns 64 uniformly random bits. It is passed in wherever a time
/// is jittered or a name is made up, so that tests decide what is drawn. Never empty, except where a member
/// that holds one says what an empty one means.
using Random = std::function<std::uint64_t()>;

/// Randomness of a running program, seeded by the operating system. Not for secrets: see secret_hex(). Copies
/// share one engine; use them in one thread.
inline Random system_random() {
    std::random_device device;
    const std::uint64_t seed = (std::uint64_t{device()} << 32) ^ device();
    return [engine = std::make_shared<std::mt19937_64>(seed)] { return (*engine)(); };
}

/// A draw in [0, 1).
inline double random_unit(const Random& random) {
    return static_cast<double>(random() >> 11) * 0x1.0p-53;
}

/// `digits` (0 or more) lower-case hexadecimal digits, for session and client ids.
inline std::string random_hex(const Random& random, int digits) {
    std::string text;
    for (int i = 0; i < digits; ++i)
        text += "0123456789abcdef"[random() >> 60];
    return text;
}

/// The same from the operating system's own generator: no attacker can compute them from others that were
/// seen.
inline std::string secret_hex(int digits) {
    return random_hex(
        [device = std::make_shared<std::random_device>()] {
            return (std::uint64_t{(*device)()} << 32) ^ (*device)();
        },
        digits);
}

}  // namespace asip
