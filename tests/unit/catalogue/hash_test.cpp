// SPDX-License-Identifier: Apache-2.0
#include "asip/catalogue/description_parts.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace asip::catalogue {
namespace {

constexpr auto kMax = std::numeric_limits<std::uint64_t>::max();

TEST(Hash, ProductByHalves_HasAllBits) {
    EXPECT_EQ(multiply_by_halves(kMax, kMax), (WideProduct{1, kMax - 1}));
    EXPECT_EQ(multiply_by_halves(kMax, 2), (WideProduct{kMax - 1, 1}));
    EXPECT_EQ(multiply_by_halves(1ULL << 63, 1ULL << 63), (WideProduct{0, 1ULL << 62}));
    EXPECT_EQ(multiply_by_halves(0, kMax), (WideProduct{0, 0}));
}

TEST(Hash, ProductByHalves_IsThatOfTheCompiler) {
    std::uint64_t a = 0x9E3779B97F4A7C15u;
    for (int i = 0; i < 100'000; ++i) {
        const std::uint64_t b = a * 0xD1342543DE82EF95u + 1;
        ASSERT_EQ(multiply_by_halves(a, b), multiply(a, b)) << a << " times " << b;
        a = b ^ (b >> 29);
    }
}

}  // namespace
}  // namespace asip::catalogue
