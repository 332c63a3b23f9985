// SPDX-License-Identifier: Apache-2.0
#include "asip/model/json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace asip::model {
namespace {

TEST(ParseJson, TextThatIsNotJson_IsRefusedWithItsPlace) {
    const std::pair<std::string_view, const char*> faults[] = {
        {"", "line 1, column 1"},
        {"{", "line 1, column 2"},
        {"{\"a\": 1,\n \"b\": 2,\n}", "line 3, column 1"},
        {"[1,\n\n  nul]", "line 3, column 6"},
        {"{}\nx", "line 2, column 1"},
        {"{'a':1}", "line 1, column 2"},
    };
    for (const auto& [text, place] : faults)
        EXPECT_EQ(parse_json(text).error(), std::string("not valid JSON: ") + place) << text;
    EXPECT_FALSE(parse_json("\"\xff\""));
}

TEST(ParseJson, ValidText_IsParsed) {
    EXPECT_EQ(dump_json(parse_json(R"( {"a":[1,2.5,"x"]} )").value()), R"({"a":[1,2.5,"x"]})");
}

TEST(ParseJson, NoJson_IsRefused) {
    for (const std::string_view text :
         {"", "{", "{}x", "{a:1}", "nul", "1e999", "\"\xff\"", "[1,]", "\"a\nb\"", "//x\n1", "]"}) {
        const auto result = parse_json(text);
        EXPECT_FALSE(result) << text;
    }
}

TEST(ParseJson, DeeperThanTheLimit_IsRefused) {
    EXPECT_TRUE(parse_json("[[[]]]", {100, 3}));
    EXPECT_FALSE(parse_json("[[[[]]]]", {100, 3}));
    EXPECT_FALSE(parse_json(R"({"a":{"a":{"a":{}}}})", {100, 3}));
    EXPECT_FALSE(parse_json(std::string(30000, '[')));
}

TEST(ParseJson, BracketsInText_DoNotCount) {
    EXPECT_TRUE(parse_json(R"(["[[[[\"[[[["])", {100, 1}));
}

TEST(ParseJson, LongerThanTheLimit_IsRefused) {
    EXPECT_TRUE(parse_json("[1,2]", {5, 1}));
    EXPECT_FALSE(parse_json("[1,2] ", {5, 1}));
    EXPECT_FALSE(parse_json(std::string(1'000'000, ' ')));
}

TEST(DumpJson, TextThatIsNoUtf8_DoesNotThrow) {
    EXPECT_EQ(dump_json(nlohmann::json("a\xff")), "\"a\xef\xbf\xbd\"");
}

TEST(JsonDepth, BracketsInStrings_DoNotCount) {
    EXPECT_TRUE(json_depth_within(R"({"a":"[[[[[[\"[[[["})", 1));
    EXPECT_TRUE(json_depth_within("[[]]", 2));
    EXPECT_FALSE(json_depth_within("[[[]]]", 2));
    EXPECT_TRUE(json_depth_within("", 0));
    EXPECT_TRUE(json_depth_within("\"\\", 0));
}

}  // namespace
}  // namespace asip::model
