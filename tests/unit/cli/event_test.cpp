// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/events/context_event.hpp"
#include "tests/unit/cli/boards.hpp"

namespace asip::cli {
namespace event_test {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const bus::Topics kTopics("asip");

ContextEvent distance_event() {
    auto event = *context_event(kTopics, "asip/uno1/distance/out", R"({"distance":[42,118]})");
    event.time = std::chrono::system_clock::time_point(1'700'000'000'042ms);
    event.age = 100ms;
    return event;
}

TEST(ContextEvent, TopicsOfTheContextBus_AreUnderstood) {
    EXPECT_EQ(distance_event().where(), "uno1/distance");
    EXPECT_EQ(context_event(kTopics, "asip/uno1/out", "@D,e,1,{4}")->kind, ContextEvent::Kind::kRaw);
    EXPECT_EQ(context_event(kTopics, "asip/uno1/servo/error", "{}")->kind, ContextEvent::Kind::kError);
    EXPECT_FALSE(context_event(kTopics, "asip/uno1/servo/in", "W,0,90"));
    EXPECT_FALSE(context_event(kTopics, "asip/u n o/servo/out", "x"));
}

TEST(EventText, TimeAndAge_WhereAskedFor) {
    EXPECT_EQ(event_text(distance_event(), "42 cm", false, false, false), "uno1/distance  42 cm");
    EXPECT_EQ(event_text(distance_event(), "42 cm", true, true, false),
              "2023-11-14T22:13:20.042Z  uno1/distance   +100 ms  42 cm");
    EXPECT_EQ(event_header(true, true, false), "TIME                      SERVICE       AGE  VALUE");
    EXPECT_EQ(event_header(false, false, false), "SERVICE  VALUE");
}

TEST(EventText, ControlCharacters_CannotReachTheTerminal) {
    const auto event = *context_event(kTopics, "asip/uno1/out", "\x1b[2J!");
    EXPECT_EQ(event_text(event, event.payload, false, false, false), "uno1  ?[2J!");
}

TEST(EventJson, ValueErrorAndLine_AreMembersOfTheirOwn) {
    EXPECT_EQ(
        event_json(distance_event()).dump(),
        R"({"age":0.1,"board":"uno1","event":{"distance":[42,118]},"service":"distance","time":"2023-11-14T22:13:20.042Z"})");
    auto raw = *context_event(kTopics, "asip/uno1/out", "@D,e,1,{4}");
    EXPECT_THAT(event_json(raw).dump(), HasSubstr(R"("line":"@D,e,1,{4}")"));
    auto broken = *context_event(kTopics, "asip/uno1/distance/out", "no json \xff");
    EXPECT_TRUE(event_json(broken)["event"].is_string());
}

TEST(EventValue, PathsIntoThePayload_AreFollowed) {
    const auto event = distance_event();
    EXPECT_EQ(event_value(event, "data.distance.1"), "118");
    EXPECT_EQ(event_value(event, "data.distance"), "[42,118]");
    EXPECT_EQ(event_value(event, "where"), "uno1/distance");
    EXPECT_EQ(event_value(event, "age"), "0.100000");
    for (const auto* name :
         {"data.distance.2", "data.nothing", "data.distance.x", "data..", "data.distance.-1"}) {
        EXPECT_EQ(event_value(event, name), "") << name;
    }
}

ContextEvent raw_line(const std::string& line) {
    return *context_event(kTopics, "asip/uno1/out", line);
}

TEST(IsWanted, RawLinesOfOneService_AreNotThoseOfAnother) {
    const auto description = *model::parse_description(kUno1);
    const std::vector<Target> distance{{"uno1", "distance"}};
    EXPECT_TRUE(is_wanted(raw_line("@D,e,2,{42,118}"), distance, &description));
    EXPECT_TRUE(is_wanted(raw_line("~D,A,2,range"), distance, &description));
    EXPECT_FALSE(is_wanted(raw_line("@I,d,0,1"), distance, &description));
    EXPECT_FALSE(is_wanted(raw_line("@#,?,0"), distance, &description));
    EXPECT_FALSE(is_wanted(raw_line("@D,e,2,{42,118}"), distance, nullptr))
        << "whose letter is not known yet";
    EXPECT_TRUE(is_wanted(raw_line("@I,d,0,1"), {{"uno1", ""}}, &description));
    EXPECT_TRUE(is_wanted(raw_line("@X,a,1"), {{"uno1", "X"}}, nullptr)) << "a service without a model";
}

TEST(IsWanted, LetterOfAService_MeansIt) {
    const auto description = *model::parse_description(kUno1);
    EXPECT_TRUE(is_wanted(distance_event(), {{"uno1", "D"}}, &description));
    EXPECT_FALSE(is_wanted(distance_event(), {{"uno1", "S"}}, &description));
    EXPECT_TRUE(is_wanted(distance_event(), {{"uno*", "dist*"}}, nullptr));
    EXPECT_FALSE(is_wanted(distance_event(), {{"uno2", ""}}, nullptr));
    EXPECT_THAT(context_filters(kTopics, {{"uno1", "D"}}, false),
                ElementsAre("asip/uno1/+/out", "asip/uno1/+/error"));
    EXPECT_TRUE(needs_description({"uno1", "D"}, false));
    EXPECT_FALSE(needs_description({"uno2", "distance"}, false));
    EXPECT_TRUE(needs_description({"uno2", "distance"}, true));
}

TEST(ContextFilters, TargetsCoveredByOthers_AreNotSubscribedTwice) {
    EXPECT_THAT(context_filters(kTopics, {{"uno1", "distance"}, {"uno1", ""}, {"uno1", ""}}, false),
                ElementsAre("asip/uno1/+/out", "asip/uno1/+/error"));
    EXPECT_THAT(context_filters(kTopics, {{"uno*", "servo"}}, false),
                ElementsAre("asip/+/servo/out", "asip/+/servo/error"));
    EXPECT_THAT(context_filters(kTopics, {{"uno1", ""}, {"uno2", ""}}, true),
                ElementsAre("asip/uno1/out", "asip/uno2/out"));
}

}  // namespace event_test
}  // namespace asip::cli
