// SPDX-License-Identifier: Apache-2.0
// The firmware's line reader and request parser against the judge of tests/firmware, on what its exhaustion
// leaves out: longer inputs, other bytes, several damages of one line. 0xFF is a second of silence.
#include <cstdint>
#include <cstdio>

#include "tests/firmware/bench.hpp"
#include "tests/fuzz/require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    constexpr std::uint8_t kSilence = 0xFF;
    wire::Bench bench(true);
    for (std::size_t i = 0; i < size && bench.judge().can_tell(); ++i) {
        const char* const wrong = data[i] == kSilence ? bench.second_of_silence() : bench.byte(data[i]);
        if (wrong) std::fprintf(stderr, "byte %zu: %s\n", i, wrong);
        REQUIRE(wrong == nullptr);
    }
    return 0;
}
