// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/body.hpp"

#include <gmock/gmock.h>

namespace asip::protocol {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(ParseBody, EachFirmwareGeneration_GivesTheSameItems) {
    EXPECT_THAT(parse_body("2,{42,118}")->items, ElementsAre("42", "118"));
    EXPECT_THAT(parse_body("2{42,118}")->items, ElementsAre("42", "118"));
    EXPECT_THAT(parse_body("2,{42,118,}")->items, ElementsAre("42", "118"));
    EXPECT_THAT(parse_body("2,{0:42,1:118}")->items, ElementsAre("0:42", "1:118"));
}

TEST(ParseBody, CountOfZero_HasNoItems) {
    EXPECT_THAT(parse_body("0,{}")->items, IsEmpty());
}

TEST(ParseBody, EmptyItems_AreItems) {
    EXPECT_THAT(parse_body("2,{,}")->items, ElementsAre("", ""));
    EXPECT_THAT(parse_body("2,{1,}")->items, ElementsAre("1", ""));
    EXPECT_THAT(parse_body("1,{1,}")->items, ElementsAre("1")) << "a comma behind the last one";
    EXPECT_THAT(parse_body("3,{,,}")->items, ElementsAre("", "", ""));
    EXPECT_THAT(parse_body("1,{}")->items, ElementsAre(""));
}

TEST(ParseBody, DamagedBody_IsRefused) {
    for (const std::string_view body :
         {"", "2", "2,", "2,{42,118", "2,42,118}", "2,{42}", "1,{42,118}", "x,{42}", ",{42}", "{42}", "-1,{}",
          "2,}{", "1,{42}x", "1.0,{42}", "99999999999999999999,{1}"}) {
        EXPECT_FALSE(parse_body(body)) << body;
    }
}

TEST(ParseBody, MoreItemsThanTheLimit_AreRefused) {
    std::string items = "0";
    for (int i = 1; i < 257; ++i)
        items += ",0";
    EXPECT_FALSE(parse_body("257,{" + items + "}"));
    EXPECT_EQ(parse_body("256,{" + items.substr(2) + "}")->items.size(), 256u);
}

TEST(SplitFields, EmptyFields_AreKept) {
    EXPECT_THAT(split_fields("3000:11"), ElementsAre("3000", "11"));
    EXPECT_THAT(split_fields("a::b:"), ElementsAre("a", "", "b", ""));
    EXPECT_THAT(split_fields(""), ElementsAre(""));
}

TEST(ParseInteger, WholeTextOnly_IsANumber) {
    EXPECT_EQ(parse_integer("-12"), -12);
    EXPECT_EQ(parse_integer("+12"), 12);
    for (const std::string_view text :
         {"", "+", "-", "+-1", "12x", " 12", "1.5", "0x1f", "9223372036854775808"}) {
        EXPECT_FALSE(parse_integer(text)) << text;
    }
}

TEST(ParseHex, WithoutPrefixAndSign_IsANumber) {
    EXPECT_EQ(parse_hex("2C"), 0x2cu);
    EXPECT_EQ(parse_hex("ffffffff"), 0xffffffffu);
    for (const std::string_view text : {"", "0x1", "-1", "g", "100000000"})
        EXPECT_FALSE(parse_hex(text)) << text;
}

}  // namespace
}  // namespace asip::protocol
