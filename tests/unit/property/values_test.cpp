// SPDX-License-Identifier: Apache-2.0
#include "asip/property/value.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace asip::property::test {
namespace {

using nlohmann::json;

Property number() {
    Property property;
    property.kind = Kind::kNumber;
    property.min = 0;
    property.max = 180;
    property.whole = true;
    property.write = Call{"servo", "write", {1, std::nullopt}};
    return property;
}

Property light() {
    Property property;
    property.kind = Kind::kLight;
    property.max = 100;
    property.write = Call{"lamp", "level", {std::nullopt}};
    property.color = Call{"lamp", "tint", {std::nullopt}};
    return property;
}

TEST(PropertyValue, WhatIsNotThereOrNoNumber_IsNone) {
    Property property;
    property.read = Place{"distance", "/distance/1"};
    EXPECT_EQ(value_in(property, json::parse(R"({"distance":[42,118]})")), json(118));
    EXPECT_EQ(value_in(property, json::parse(R"({"distance":[42,null]})")), json(nullptr));
    for (const auto* text : {R"({"distance":[42]})", R"({"distance":7})", "[]", R"({"other":[1,2]})",
                             R"({"distance":{"1":[]}})", "17", "null"})
        EXPECT_FALSE(value_in(property, json::parse(text))) << text;
}

TEST(PropertyValue, WordsOfASensor_StandForItsNumbers) {
    Property property;
    property.read = Place{"own", "/mode"};
    property.choices = {{"eco", 0}, {"turbo", 2}};
    EXPECT_EQ(value_in(property, json{{"mode", 2}}), json("turbo"));
    EXPECT_FALSE(value_in(property, json{{"mode", 1}})) << "none of its choices";
}

TEST(PropertyRequest, ValueOutsideItsRange_IsNone) {
    EXPECT_EQ(requests_for(number(), 180)[0].payload, R"({"write":[1,180]})");
    for (const auto& bad :
         {json(181), json(-1), json(1.5), json("90"), json(nullptr), json(true), json::array()})
        EXPECT_TRUE(requests_for(number(), bad).empty()) << bad;
}

TEST(PropertyRequest, TextThatIsTooLong_IsNone) {
    Property property;
    property.kind = Kind::kText;
    property.max_length = 3;
    property.write = Call{"lcd", "write", {0, std::nullopt}};
    EXPECT_EQ(requests_for(property, "abc")[0].payload, R"({"write":[0,"abc"]})");
    EXPECT_TRUE(requests_for(property, "abcd").empty());
    EXPECT_TRUE(requests_for(property, 3).empty());
}

TEST(PropertyRequest, LightIsScaledToItsRange) {
    EXPECT_EQ(requests_for(light(), {{"on", true}, {"brightness", 128}}),
              (std::vector<Request>{{"lamp", R"({"level":[50]})"}}));
    EXPECT_EQ(requests_for(light(), {{"on", true}, {"color", 255}}),
              (std::vector<Request>{{"lamp", R"({"tint":[255]})"}, {"lamp", R"({"level":[100]})"}}));
    EXPECT_EQ(requests_for(light(), {{"on", false}}), (std::vector<Request>{{"lamp", R"({"level":[0]})"}}));
    auto colored = light();
    colored.write.reset();
    EXPECT_EQ(requests_for(colored, {{"on", false}}), (std::vector<Request>{{"lamp", R"({"tint":[0]})"}}));
    for (const auto* bad :
         {"{}", R"({"on":1})", R"({"on":true,"brightness":256})", R"({"on":true,"color":-1})", "7"})
        EXPECT_TRUE(requests_for(light(), json::parse(bad)).empty()) << bad;
}

TEST(PropertyLight, ThatIsOnlyOnOrOff_MayBeInverted) {
    Property lamp;
    lamp.kind = Kind::kLight;
    lamp.max = 1;
    lamp.write = Call{"io", "write", {13, std::nullopt}};
    for (const int on : {0, 1}) {
        lamp.choices = {{"off", 1 - on}, {"on", on}};
        const auto written = [&](bool lit) {
            return json::parse(requests_for(lamp, {{"on", lit}})[0].payload)["write"][1];
        };
        EXPECT_EQ(written(true), on);
        EXPECT_EQ(written(false), 1 - on);
        EXPECT_EQ(light_of(lamp, on, std::nullopt), json({{"on", true}}));
        EXPECT_EQ(light_of(lamp, 1 - on, std::nullopt), json({{"on", false}}));
    }
}

TEST(PropertyLight, IsOnWhereItsLevelIsAboveZero) {
    EXPECT_EQ(light_of(light(), 50, std::nullopt), json({{"on", true}, {"brightness", 128}}));
    EXPECT_EQ(light_of(light(), 50, 0xff0000),
              json({{"on", true}, {"brightness", 128}, {"color", 0xff0000}}));
    EXPECT_EQ(light_of(light(), 0, 0xff0000), json({{"on", false}, {"color", 0xff0000}}));
    EXPECT_FALSE(light_of(light(), std::nullopt, 0xff0000));
    auto colored = light();
    colored.write.reset();
    EXPECT_EQ(light_of(colored, std::nullopt, 0), json({{"on", false}}));
}

/// A list of properties may say that a light is read from anywhere.
TEST(PropertyLight, RawValue_IsNone) {
    auto read = light();
    read.read = Place{"lamp", "/level/0"};
    read.max_length = 9;
    for (const auto& raw : {json(50), json("on"), json(true)})
        EXPECT_FALSE(value_in(read, json{{"level", {raw}}})) << raw;
}

TEST(ValueOf, NumberThatSaysNone_IsNoValue) {
    Property distance;
    distance.kind = Kind::kSensor;
    distance.min = 0;
    distance.max = 400;
    distance.none = 0;
    EXPECT_EQ(value_of(distance, 0), json());
    EXPECT_EQ(value_of(distance, 42), json(42));
    EXPECT_EQ(value_of(distance, 401), std::nullopt);
}

}  // namespace
}  // namespace asip::property::test
