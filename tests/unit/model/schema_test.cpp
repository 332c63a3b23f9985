// SPDX-License-Identifier: Apache-2.0
#include "asip/model/schema.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace asip::model {
namespace {

using nlohmann::json;

std::string fault(const char* schema, const char* document) {
    const auto result = check_schema(json::parse(schema), json::parse(document));
    return result ? "" : result.error();
}

TEST(CheckSchema, Type_IsChecked) {
    EXPECT_EQ(fault(R"({"type":"integer"})", "1"), "");
    EXPECT_EQ(fault(R"({"type":"integer"})", "1.5"), "/: is 1.5, not of type integer");
    EXPECT_EQ(fault(R"({"type":"string"})", "[]"), "/: is [], not of type string");
    EXPECT_EQ(fault(R"({"type":"number"})", "1"), "");
}

TEST(CheckSchema, Place_IsThatOfTheFault) {
    const auto* schema = R"({"properties":{"a":{"items":{"properties":{"b":{"type":"string"}}}}}})";
    EXPECT_EQ(fault(schema, R"({"a":[{"b":"x"},{"b":1}]})"), "/a/1/b: is 1, not of type string");
}

TEST(CheckSchema, Members_AreRequiredAndKnown) {
    const auto* schema = R"({"required":["a"],"properties":{"a":{}},"additionalProperties":false})";
    EXPECT_EQ(fault(schema, R"({"a":1})"), "");
    EXPECT_EQ(fault(schema, "{}"), "/: has no member \"a\"");
    EXPECT_EQ(fault(schema, R"({"a":1,"b":2})"), "/b: no such member is known here");
}

TEST(CheckSchema, AdditionalAndPatternProperties_HaveTheirSchema) {
    EXPECT_EQ(fault(R"({"additionalProperties":{"type":"string"}})", R"({"x":1})"),
              "/x: is 1, not of type string");
    EXPECT_EQ(fault(R"({"patternProperties":{"^a":{"type":"string"}},"additionalProperties":false})",
                    R"({"ab":1})"),
              "/ab: is 1, not of type string");
    EXPECT_EQ(fault(R"({"propertyNames":{"pattern":"^[a-z]$"}})", R"({"A":1})"),
              "/A: \"A\" does not match ^[a-z]$");
}

TEST(CheckSchema, Bounds_AreChecked) {
    EXPECT_EQ(fault(R"({"minimum":1})", "0"), "/: 0 is below 1");
    EXPECT_EQ(fault(R"({"maximum":1})", "2"), "/: 2 is above 1");
    EXPECT_EQ(fault(R"({"minLength":1})", R"("")"), "/: is shorter than 1 bytes");
    EXPECT_EQ(fault(R"({"maxLength":1})", R"("ab")"), "/: is longer than 1 bytes");
    EXPECT_EQ(fault(R"({"minItems":1})", "[]"), "/: has fewer than 1 items");
    EXPECT_EQ(fault(R"({"maxItems":1})", "[1,2]"), "/: has more than 1 items");
    EXPECT_EQ(fault(R"({"minProperties":1})", "{}"), "/: has fewer than 1 members");
    EXPECT_EQ(fault(R"({"maxProperties":0})", R"({"a":1})"), "/: has more than 0 members");
}

TEST(CheckSchema, EnumConstPatternAnyOf_AreChecked) {
    EXPECT_EQ(fault(R"({"enum":["a","b"]})", R"("c")"), R"(/: is "c", not one of ["a","b"])");
    EXPECT_EQ(fault(R"({"const":1})", "2"), "/: is not 1");
    EXPECT_EQ(fault(R"({"pattern":"^[A-Z]$"})", R"("ab")"), "/: \"ab\" does not match ^[A-Z]$");
    EXPECT_EQ(fault(R"({"anyOf":[{"type":"string"},{"type":"null"}]})", "null"), "");
    EXPECT_EQ(fault(R"({"anyOf":[{"type":"string"},{"type":"null"}]})", "1"),
              "/: fits none of the forms allowed here");
}

TEST(CheckSchema, LongTextForAPattern_IsRefusedNotMatched) {
    const json text = std::string(60000, 'a');
    EXPECT_FALSE(check_schema(json::parse(R"({"pattern":"^(a|b)*$"})"), text));
}

TEST(CheckSchema, Reference_IsFollowedIntoDefinitions) {
    const auto* schema = R"({"items":{"$ref":"#/definitions/n"},"definitions":{"n":{"type":"integer"}}})";
    EXPECT_EQ(fault(schema, "[1,2]"), "");
    EXPECT_EQ(fault(schema, "[1,\"x\"]"), "/1: is \"x\", not of type integer");
}

TEST(CheckSchema, BrokenSchema_IsReportedNotThrown) {
    EXPECT_NE(fault(R"({"$ref":"#/definitions/none"})", "1"), "");
    EXPECT_NE(fault(R"({"$ref":"#/definitions/a","definitions":{"a":{"$ref":"#/definitions/a"}}})", "1"), "");
    EXPECT_NE(fault(R"({"oneOf":[]})", "1"), "");
    EXPECT_NE(fault(R"({"type":7})", "1"), "");
    EXPECT_NE(fault(R"({"pattern":"["})", "\"a\""), "");
}

}  // namespace
}  // namespace asip::model
