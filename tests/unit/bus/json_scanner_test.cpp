// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/json/json_scanner.hpp"

#include <nlohmann/json.hpp>

#include <gmock/gmock.h>

#include <string>
#include <utility>
#include <vector>

namespace asip::bus {
namespace {

using testing::ElementsAre;
using testing::Pair;
using Member = std::pair<std::string, std::string>;

bool is_value(std::string_view text) {
    JsonScanner scanner(text);
    std::string_view raw;
    return scanner.value(raw) && scanner.at_end();
}

TEST(JsonScanner, ObjectWithEveryKindOfValue_IsTakenApart) {
    JsonScanner scanner(R"( { "a" : -1.5e3 , "b":"x\n\u00e4", "c":[1,{"d":null}],"e":true } )");
    ASSERT_TRUE(scanner.enter_object());
    std::vector<Member> members;
    std::string_view key, value;
    while (scanner.next_member(key)) {
        ASSERT_TRUE(scanner.value(value)) << key;
        members.emplace_back(key, value);
    }
    EXPECT_TRUE(scanner.left());
    EXPECT_TRUE(scanner.at_end());
    EXPECT_THAT(members, ElementsAre(Pair("a", "-1.5e3"), Pair("b", R"("x\n\u00e4")"),
                                     Pair("c", R"([1,{"d":null}])"), Pair("e", "true")));
}

TEST(JsonScanner, ContainersInsideOthers_AreEnteredAndLeft) {
    JsonScanner scanner(R"([[],[1,2],{},{"k":[]},3])");
    ASSERT_TRUE(scanner.enter_array());
    std::string_view raw, key;
    ASSERT_TRUE(scanner.next_element() && scanner.enter_array());
    EXPECT_FALSE(scanner.next_element());
    EXPECT_TRUE(scanner.left());
    ASSERT_TRUE(scanner.next_element() && scanner.enter_array());
    ASSERT_TRUE(scanner.next_element() && scanner.value(raw));
    ASSERT_TRUE(scanner.next_element() && scanner.value(raw));
    EXPECT_FALSE(scanner.next_element());
    ASSERT_TRUE(scanner.next_element() && scanner.enter_object());
    EXPECT_FALSE(scanner.next_member(key));
    ASSERT_TRUE(scanner.next_element() && scanner.enter_object());
    ASSERT_TRUE(scanner.next_member(key) && scanner.enter_array());
    EXPECT_FALSE(scanner.next_element());
    EXPECT_FALSE(scanner.next_member(key));
    EXPECT_TRUE(scanner.left());
    ASSERT_TRUE(scanner.next_element() && scanner.value(raw));
    EXPECT_EQ(raw, "3");
    EXPECT_FALSE(scanner.next_element());
    EXPECT_TRUE(scanner.left() && scanner.at_end());
}

TEST(JsonScanner, NoCommaAfterAnEmptyContainer_IsAFault) {
    JsonScanner scanner("[[] 1]");
    ASSERT_TRUE(scanner.enter_array() && scanner.next_element() && scanner.enter_array());
    EXPECT_FALSE(scanner.next_element());
    EXPECT_FALSE(scanner.next_element());
    EXPECT_FALSE(scanner.left());
}

TEST(JsonScanner, PlainStringAndInteger_AreReadOrLeftAlone) {
    JsonScanner scanner(R"(["text","a\n",12,-1,1.5,18446744073709551616,007])");
    std::string_view text;
    std::uint64_t number = 0;
    ASSERT_TRUE(scanner.enter_array() && scanner.next_element());
    EXPECT_FALSE(scanner.unsigned_integer(number));
    ASSERT_TRUE(scanner.plain_string(text));
    EXPECT_EQ(text, "text");
    ASSERT_TRUE(scanner.next_element());
    EXPECT_FALSE(scanner.plain_string(text)) << "it holds an escape";
    ASSERT_TRUE(scanner.value(text) && scanner.next_element());
    ASSERT_TRUE(scanner.unsigned_integer(number));
    EXPECT_EQ(number, 12u);
    for (int i = 0; i < 3; ++i) {
        ASSERT_TRUE(scanner.next_element());
        EXPECT_FALSE(scanner.unsigned_integer(number));
        ASSERT_TRUE(scanner.value(text));
    }
    ASSERT_TRUE(scanner.next_element());
    EXPECT_FALSE(scanner.unsigned_integer(number));
    EXPECT_FALSE(scanner.value(text) && scanner.next_element()) << "a number does not begin with 0";
}

TEST(JsonScanner, KnownValue_IsSkippedOnlyWhenItStandsThere) {
    JsonScanner scanner(R"([{"a":1},2])");
    ASSERT_TRUE(scanner.enter_array() && scanner.next_element());
    EXPECT_FALSE(scanner.known_value(R"({"a":2})"));
    EXPECT_FALSE(scanner.known_value(""));
    EXPECT_TRUE(scanner.known_value(R"({"a":1})"));
    std::string_view raw;
    ASSERT_TRUE(scanner.next_element() && scanner.value(raw));
    EXPECT_EQ(raw, "2");
}

TEST(JsonScanner, KnownRest_LeavesItsArray) {
    JsonScanner scanner(R"([[1,"a" ],[2,"a" ],[3,"b"],[4]])");
    std::string_view raw;
    ASSERT_TRUE(scanner.enter_array() && scanner.next_element());
    ASSERT_TRUE(scanner.enter_array() && scanner.next_element() && scanner.value(raw));
    const char* const begin = scanner.position();
    ASSERT_TRUE(scanner.next_element() && scanner.value(raw));
    ASSERT_FALSE(scanner.next_element());
    const auto rest = scanner.since(begin);
    EXPECT_EQ(rest, R"(,"a" ])");
    ASSERT_TRUE(scanner.next_element() && scanner.enter_array() && scanner.next_element() &&
                scanner.value(raw));
    ASSERT_TRUE(scanner.known_rest(rest));
    EXPECT_TRUE(scanner.left());
    ASSERT_TRUE(scanner.next_element() && scanner.enter_array() && scanner.next_element() &&
                scanner.value(raw));
    EXPECT_FALSE(scanner.known_rest(rest));
    EXPECT_FALSE(scanner.known_rest(""));
    ASSERT_TRUE(scanner.next_element() && scanner.value(raw));
    ASSERT_TRUE(!scanner.next_element() && scanner.left());
    ASSERT_TRUE(scanner.next_element() && scanner.value(raw));
    EXPECT_EQ(raw, "[4]");
    EXPECT_TRUE(!scanner.next_element() && scanner.left() && scanner.at_end());
}

TEST(JsonScanner, WhatIsNoJson_IsRefused) {
    for (const std::string_view text : {"",
                                        " ",
                                        "nul",
                                        "nulll",
                                        "tru",
                                        "01",
                                        "1.",
                                        ".5",
                                        "-",
                                        "+1",
                                        "1e",
                                        "1e+",
                                        "'a'",
                                        "\"a",
                                        "\"\\x\"",
                                        "\"\\u12g4\"",
                                        "\"\t\"",
                                        "[1,]",
                                        "[,1]",
                                        "[1 2]",
                                        "[1",
                                        "]",
                                        "{\"a\"}",
                                        "{\"a\":}",
                                        "{a:1}",
                                        "{\"a\":1,}",
                                        "{,}",
                                        "[1]]",
                                        "\"\xff\"",
                                        "\"\xc0\x80\"",
                                        "\"\xed\xa0\x80\"",
                                        "\"\xf4\x90\x80\x80\"",
                                        "\"\xe2\x82\"",
                                        "/**/1"}) {
        EXPECT_FALSE(is_value(text)) << text;
    }
}

TEST(JsonScanner, NumbersBeyondADouble_AreRefusedAsTheParserDoes) {
    const auto digits = [](std::size_t count) { return "1" + std::string(count - 1, '0'); };
    for (const auto& text :
         {std::string("1e400"), std::string("-1e400"), std::string("1E+309"), std::string("1.8e308"),
          digits(310), std::string("0.001e312"), std::string("1e99999999999999999999"),
          std::string("123456e304"), "0." + std::string(50, '0') + "1e360"}) {
        EXPECT_FALSE(is_value(text)) << text;
        EXPECT_FALSE(nlohmann::json::accept(text)) << text;
    }
    for (const auto& text :
         {std::string("1e308"), std::string("-1.7e308"), std::string("1e-400"), std::string("0e400"),
          std::string("0.0e99999999999999999999"), std::string("1e-99999999999999999999"), digits(41),
          digits(308), "0." + std::string(50, '0') + "1e350", "0." + std::string(400, '3'),
          std::string("123456e-400")}) {
        EXPECT_TRUE(is_value(text)) << text;
        EXPECT_TRUE(nlohmann::json::accept(text)) << text;
    }
}

TEST(JsonScanner, EscapesInKeys_AreUndone) {
    JsonScanner scanner(R"({"s\u0065rvices":1,"a\"b\\":2,"\ud83d\ude00":3,"plain":4})");
    std::string_view key, value;
    ASSERT_TRUE(scanner.enter_object());
    for (const std::string_view name : {"services", "a\"b\\", "\U0001F600", "plain"}) {
        ASSERT_TRUE(scanner.next_member(key));
        EXPECT_EQ(key, name);
        ASSERT_TRUE(scanner.value(value));
    }
    EXPECT_EQ(scanner.raw_key(), "plain");
    EXPECT_FALSE(scanner.next_member(key));
    EXPECT_TRUE(scanner.left() && scanner.at_end());
}

TEST(JsonScanner, NestingAtTheLimit_IsTakenAndBeyondIsRefused) {
    const auto nested = [](int depth) {
        return std::string(static_cast<std::size_t>(depth), '[') +
               std::string(static_cast<std::size_t>(depth), ']');
    };
    EXPECT_TRUE(is_value(nested(JsonScanner::kMaxDepth)));
    EXPECT_FALSE(is_value(nested(JsonScanner::kMaxDepth + 1)));
    EXPECT_FALSE(is_value(std::string(1'000'000, '[')));
}

}  // namespace
}  // namespace asip::bus
