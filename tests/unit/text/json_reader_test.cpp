// SPDX-License-Identifier: Apache-2.0
#include "asip/text/json_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace asip::text {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class JsonReaderTest : public ::testing::Test {
  protected:
    JsonReader reader(const char* text, JsonReader::Nulls nulls = JsonReader::Nulls::kFault) {
        document_ = json::parse(text);
        fault_.clear();
        return JsonReader(document_, "", fault_, nulls);
    }

    json document_;
    std::string fault_;
};

TEST_F(JsonReaderTest, MembersOfTheRightType_AreRead) {
    auto in = reader(R"({"name":"uno","count":7,"gain":0.5,"on":true,"words":["a","b"],"word":"c"})");
    EXPECT_EQ(in.text("name"), "uno");
    EXPECT_EQ(in.integer("count", 0, 7), 7U);
    EXPECT_DOUBLE_EQ(in.number("gain", 1, 0, 1), 0.5);
    EXPECT_TRUE(in.flag("on"));
    EXPECT_THAT(in.texts("words", 2, 1), ElementsAre("a", "b"));
    EXPECT_THAT(in.texts("word", 2, 1), ElementsAre("c"));
    in.refuse_others();
    EXPECT_TRUE(in.ok()) << fault_;
}

TEST_F(JsonReaderTest, AbsentMembers_GiveTheirDefaults) {
    auto in = reader("{}");
    EXPECT_EQ(in.text("name", "none"), "none");
    EXPECT_EQ(in.integer("count", 1, 2), std::nullopt);
    EXPECT_DOUBLE_EQ(in.number("gain", 0.25, 0, 1), 0.25);
    EXPECT_FALSE(in.flag("on"));
    EXPECT_THAT(in.texts("words", 2, 1), IsEmpty());
    EXPECT_FALSE(in.object("link"));
    EXPECT_THAT(in.list("parts"), IsEmpty());
    EXPECT_THAT(in.members("events"), IsEmpty());
    EXPECT_TRUE(in.ok()) << fault_;
}

TEST_F(JsonReaderTest, FirstFault_IsKeptWithItsPlace) {
    auto in = reader(R"({"parts":[{"pin":1},{"pin":"x"}],"name":7})");
    for (auto& part : in.list("parts"))
        part.integer("pin", 0, 20);
    EXPECT_FALSE(in.ok());
    EXPECT_EQ(in.text("name", "none"), "none");
    EXPECT_EQ(fault_, "/parts/1/pin: is not an integer");
}

TEST_F(JsonReaderTest, EachWrongType_HasItsReason) {
    const auto fault = [this](const char* text, auto&& read) {
        auto in = reader(text);
        read(in);
        return fault_;
    };
    EXPECT_EQ(fault(R"({"a":1})", [](auto& in) { in.text("a"); }), "/a: is not a string");
    EXPECT_EQ(fault(R"({"a":"xyz"})", [](auto& in) { in.text("a", "", 2); }), "/a: is longer than 2 bytes");
    EXPECT_EQ(fault(R"({"a":1.5})", [](auto& in) { in.integer("a", 0, 9); }), "/a: is not an integer");
    EXPECT_EQ(fault(R"({"a":-1})", [](auto& in) { in.integer("a", 0, 9); }), "/a: -1 is below 0");
    EXPECT_EQ(fault(R"({"a":0})", [](auto& in) { in.integer("a", 1, 9); }), "/a: 0 is below 1");
    EXPECT_EQ(fault(R"({"a":18446744073709551615})", [](auto& in) { in.integer("a", 0, 9); }),
              "/a: 18446744073709551615 is above 9");
    EXPECT_EQ(fault(R"({"a":2})", [](auto& in) { in.number("a", 0, -0.5, 1); }),
              "/a: 2 is not a number from -0.5 to 1");
    EXPECT_EQ(fault(R"({"a":"yes"})", [](auto& in) { in.flag("a"); }), "/a: is not true or false");
    EXPECT_EQ(fault(R"({"a":["x",1]})", [](auto& in) { in.texts("a", 2, 3); }),
              "/a: is not a string or an array of at most 2 strings, each of at most 3 bytes");
    EXPECT_EQ(fault(R"({"a":[]})", [](auto& in) { in.object("a"); }), "/a: is not an object");
    EXPECT_EQ(fault(R"({"a":{}})", [](auto& in) { in.list("a"); }), "/a: is not an array");
    EXPECT_EQ(fault(R"({"a":[{},{}]})", [](auto& in) { in.list("a", 1); }), "/a: has more than 1 items");
    EXPECT_EQ(fault(R"({"a":[{},7]})", [](auto& in) { in.list("a"); }), "/a/1: is not an object");
    EXPECT_EQ(fault(R"({"a":{"b":7}})", [](auto& in) { in.members("a"); }), "/a/b: is not an object");
    EXPECT_EQ(fault("{}", [](auto& in) { in.required("a"); }), "/a: is missing");
    EXPECT_EQ(fault("[]", [](auto& in) { in.text("a"); }), "/: is not an object");
}

TEST_F(JsonReaderTest, Null_IsAFaultOrAbsentAsAsked) {
    auto strict = reader(R"({"a":null})");
    strict.text("a");
    EXPECT_EQ(fault_, "/a: is not a string");
    auto lenient = reader(R"({"a":null})", JsonReader::Nulls::kAbsent);
    EXPECT_EQ(lenient.text("a", "none"), "none");
    EXPECT_EQ(lenient.integer("a", 1, 2), std::nullopt);
    lenient.refuse_others();
    EXPECT_TRUE(lenient.ok()) << fault_;
}

TEST_F(JsonReaderTest, MemberNobodyAskedFor_IsRefusedWithTheNearest) {
    auto in = reader(R"({"limt":5})");
    in.integer("limit", 1, 10);
    in.refuse_others();
    EXPECT_EQ(fault_, "/limt: is unknown (did you mean \"limit\"?)");
}

TEST_F(JsonReaderTest, KeysWithControlCharacters_AreShownEscaped) {
    auto in = reader(R"({"\u001b[2J":5})");
    in.refuse_others();
    EXPECT_EQ(fault_, "/\\x1b[2J: is unknown");
}

}  // namespace
}  // namespace asip::text
