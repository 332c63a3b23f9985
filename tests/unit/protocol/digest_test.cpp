// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/checksum.hpp"

#include <gtest/gtest.h>

#include <string>

namespace asip::protocol {
namespace {

std::uint16_t digest_of(std::initializer_list<std::string_view> lines) {
    Digest digest;
    for (const auto line : lines)
        digest.add(line);
    return digest.value();
}

// As AVR boards answer: see tests/unit/firmware.
TEST(Digest, IsThatOfTheFirmware) {
    EXPECT_EQ(digest_of({}), 0u);
    EXPECT_EQ(digest_of({"#,V,a"}), 55845u);
    EXPECT_EQ(digest_of({"I,d,13,1", "#,V,a"}), 4660u);
    Digest with_error;
    with_error.add("I,d,99,1", 3);
    with_error.add("#,V,a");
    EXPECT_EQ(with_error.value(), 37764u);
}

TEST(Digest, LineEndsCount) {
    EXPECT_NE(digest_of({"I,d,1", "3,1"}), digest_of({"I,d,13,1"}));
    EXPECT_NE(digest_of({"", "I,d,13,1"}), digest_of({"I,d,13,1", ""}));
}

TEST(Digest, EachPairOfChangedBits_IsNoticed) {
    const std::string line = "S,W,0,90";
    const auto right = digest_of({line});
    for (std::size_t a = 0; a < line.size() * 8; ++a) {
        for (std::size_t b = a + 1; b < line.size() * 8; ++b) {
            auto damaged = line;
            damaged[a / 8] = static_cast<char>(damaged[a / 8] ^ (1 << a % 8));
            damaged[b / 8] = static_cast<char>(damaged[b / 8] ^ (1 << b % 8));
            ASSERT_NE(digest_of({damaged}), right) << damaged;
        }
    }
}

}  // namespace
}  // namespace asip::protocol
