// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/entity.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace asip::gateway::exports {
namespace {

using nlohmann::json;

Entity number() {
    Entity entity;
    entity.kind = EntityKind::kNumber;
    entity.min = 0;
    entity.max = 180;
    entity.whole = true;
    entity.write = Call{"servo", "write", {1, std::nullopt}, "angle", true};
    return entity;
}

Entity light() {
    Entity entity;
    entity.kind = EntityKind::kLight;
    entity.max = 100;
    entity.write = Call{"lamp", "level", {std::nullopt}};
    entity.color = Call{"lamp", "tint", {std::nullopt}};
    return entity;
}

TEST(ExportedValue, WhatIsNotThereOrNoNumber_IsNone) {
    Entity entity;
    entity.read = ValuePlace{"distance", "/distance/1"};
    EXPECT_EQ(value_in(entity, json::parse(R"({"distance":[42,118]})")), json(118));
    EXPECT_EQ(value_in(entity, json::parse(R"({"distance":[42,null]})")), json(nullptr));
    for (const auto* text : {R"({"distance":[42]})", R"({"distance":7})", "[]", R"({"other":[1,2]})",
                             R"({"distance":{"1":[]}})", "17", "null"})
        EXPECT_FALSE(value_in(entity, json::parse(text))) << text;
}

TEST(ExportedValue, WordsOfASensor_StandForItsNumbers) {
    Entity entity;
    entity.read = ValuePlace{"own", "/mode"};
    entity.options = {{"eco", 0}, {"turbo", 2}};
    EXPECT_EQ(value_in(entity, json{{"mode", 2}}), json("turbo"));
    EXPECT_EQ(value_in(entity, json{{"mode", 1}}), json(1));
}

TEST(ExportedRequest, ValueOutsideItsRange_IsNone) {
    EXPECT_EQ(requests_for(number(), 180)[0].payload, R"({"write":[1,180]})");
    for (const auto& bad :
         {json(181), json(-1), json(1.5), json("90"), json(nullptr), json(true), json::array()})
        EXPECT_TRUE(requests_for(number(), bad).empty()) << bad;
}

TEST(ExportedRequest, TextThatIsTooLong_IsNone) {
    Entity entity;
    entity.kind = EntityKind::kText;
    entity.max_length = 3;
    entity.write = Call{"lcd", "write", {0, std::nullopt}};
    EXPECT_EQ(requests_for(entity, "abc")[0].payload, R"({"write":[0,"abc"]})");
    EXPECT_TRUE(requests_for(entity, "abcd").empty());
    EXPECT_TRUE(requests_for(entity, 3).empty());
}

TEST(ExportedRequest, LightIsScaledToItsRange) {
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

TEST(ExportedProof, WhatTheBoardExecuted_IsTheValue) {
    EXPECT_EQ(value_set(number(), json::parse(R"({"write":{"0":10,"1":90}})")), json(90));
    for (const auto* text : {R"({"write":{"0":90}})", R"({"remap":{"1":90}})", R"({"write":90})",
                             R"({"write":{"1":"a"}})", R"({"write":{"1":{}}})", "{}", "null", "[]", "7"})
        EXPECT_FALSE(value_set(number(), json::parse(text))) << text;
}

TEST(ExportedProof, OneOfSeveralArguments_IsTheValue) {
    Entity tone;
    tone.kind = EntityKind::kNumber;
    tone.write = Call{"tone", "play", {std::nullopt, 500}, "frequency"};
    EXPECT_EQ(value_set(tone, json::parse(R"({"play":{"duration":20,"frequency":440}})")), json(440));
    EXPECT_FALSE(value_set(tone, json::parse(R"({"play":{"duration":20}})")));
}

TEST(ExportedProof, LightIsOnWhereItsLevelIsAboveZero) {
    EXPECT_EQ(value_set(light(), json::parse(R"({"level":50})")), json({{"on", true}, {"brightness", 128}}));
    EXPECT_EQ(value_set(light(), json::parse(R"({"level":50,"tint":16711680})")),
              json({{"on", true}, {"brightness", 128}, {"color", 0xff0000}}));
    EXPECT_EQ(value_set(light(), json::parse(R"({"level":0,"tint":16711680})")),
              json({{"on", false}, {"color", 0xff0000}}));
    EXPECT_FALSE(value_set(light(), json::parse(R"({"tint":16711680})")));
    auto colored = light();
    colored.write.reset();
    EXPECT_EQ(value_set(colored, json::parse(R"({"tint":0})")), json({{"on", false}}));
}

TEST(ExportedProof, SwitchShowsItsWords) {
    Entity entity;
    entity.kind = EntityKind::kSwitch;
    entity.options = {{"off", 1}, {"on", 0}};
    entity.write = Call{"own", "swing", {std::nullopt}, "swing"};
    EXPECT_EQ(value_set(entity, json{{"swing", 0}}), json(true));
    EXPECT_EQ(value_set(entity, json{{"swing", 1}}), json(false));
    EXPECT_FALSE(value_set(entity, json{{"swing", 2}}));
}

}  // namespace
}  // namespace asip::gateway::exports
