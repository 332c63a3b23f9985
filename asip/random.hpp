#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <string>

namespace asip {

/// Where randomness comes from: each call returns 64 uniformly random bits. Passed in wherever something is
/// jittered or named at random, so that tests can say what is drawn.
using Random = std::function<std::uint64_t()>;

/// Randomness of a running program, seeded by the operating system. Not for secrets.
inline Random system_random() {
    std::random_device device;
    const std::uint64_t seed = (std::uint64_t{device()} << 32) ^ device();
    return [engine = std::make_shared<std::mt19937_64>(seed)] { return (*engine)(); };
}

/// A draw in [0, 1).
inline double random_unit(const Random& random) {
    return static_cast<double>(random() >> 11) * 0x1.0p-53;
}

/// `digits` lower-case hexadecimal digits, for session and client ids.
inline std::string random_hex(const Random& random, int digits) {
    std::string text;
    for (int i = 0; i < digits; ++i)
        text += "0123456789abcdef"[random() >> 60];
    return text;
}

}  // namespace asip
