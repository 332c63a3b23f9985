// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "cli/ask/bus_session.hpp"
#include "cli/events/context_event.hpp"
#include "cli/events/top_model.hpp"
#include "cli/text/table.hpp"
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

TEST(TopModel, FirstSeconds_RateIsOverWhatWasHeard) {
    const Time began{};
    TopModel model(5s);
    model.begin(began);
    for (int i = 0; i < 10; ++i)
        model.value("uno1", "distance", R"({"distance":[1]})", began + i * 100ms);
    EXPECT_NEAR(model.records(began + 1s)[0]["rate"].get<double>(), 10, 0.01) << "top -n 1";
    for (int i = 10; i < 100; ++i)
        model.value("uno1", "distance", R"({"distance":[1]})", began + i * 100ms);
    EXPECT_NEAR(model.records(began + 10s)[0]["rate"].get<double>(), 10, 1.1) << "in slots of half a second";
}

TEST(TopModel, ManyRows_OfATerminalAsManyAsFitTheHighestFirst) {
    const Time now{};
    TopModel model(5s);
    model.begin(now - 5s);
    for (int board = 0; board < 1500; ++board)
        for (int i = 0; i < board % 7; ++i)
            model.value("uno" + std::to_string(board), "distance", "{}", now);
    model.error("uno4", "distance", now);
    model.sort_by(TopModel::Order::kErrors);
    const auto text = model.table(now, 26).render(0, false);
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 27) << "and its head";
    EXPECT_GT(model.left_out(), 1000u);
    EXPECT_LT(text.find("uno4 "), text.find("uno1 ")) << text;
    model.sort_by(TopModel::Order::kRate);
    EXPECT_DOUBLE_EQ(model.records(now)[0]["rate"], 6 / 5.0);
    model.sort_by(TopModel::Order::kName);
    EXPECT_EQ(model.records(now)[0]["board"], "uno1");
}

TEST(TopModel, RatesAgesAndErrors_AreOfTheWindow) {
    constexpr Time kStart{1000s};
    TopModel model(5s);
    model.state("uno1", "online");
    model.announced("uno1", "distance", 100);
    model.announced("uno1", "servo", std::nullopt);
    for (int i = 0; i < 50; ++i)
        model.value("uno1", "distance", R"({"distance":[42]})", kStart + i * 100ms);
    model.error("uno1", "servo", kStart);
    model.round_trip("uno1", 1500us);
    const auto text = model.table(kStart + 4950ms).render(0, false);
    EXPECT_THAT(text, HasSubstr("uno1   online  1.50 ms  distance  10.0/s  50 ms       0  \u2581"));
    EXPECT_THAT(text, HasSubstr("{\"distance\":[42]}"));
    EXPECT_THAT(text, HasSubstr("servo"));
    EXPECT_THAT(model.table(kStart + 20s).render(0, false), HasSubstr("0.0/s"));
}

TEST(TopModel, Trend_IsOfTheFirstNumberAtMostTwiceASecond) {
    const Time start{};
    TopModel model(5s);
    for (int i = 0; i < 40; ++i)
        model.value("uno1", "distance", R"({"distance":[)" + std::to_string(i / 10) + ",7]}",
                    start + i * 100ms);
    model.value("uno1", "log", R"({"text":"no number"})", start + 4s);
    model.value("uno1", "broken", "{", start + 4s);
    const auto shown = model.table(start + 4s).render(200, false);
    EXPECT_THAT(shown, HasSubstr("TREND"));
    EXPECT_THAT(shown, HasSubstr(" \u2581\u2581\u2583\u2583\u2586\u2586\u2588\u2588 "));
    for (int i = 0; i < 100; ++i)
        model.value("uno1", "distance", R"({"distance":[1]})", start + 5s + i * 1s);
    EXPECT_THAT(model.table(start + 105s).render(200, false),
                HasSubstr(" \u2581\u2581\u2581\u2581\u2581\u2581\u2581\u2581\u2581\u2581\u2581\u2581 "));
}

TEST(TopModel, NumbersWhoseDifferenceIsNone_AreDrawn) {
    const Time start{};
    TopModel model(5s);
    int seconds = 0;
    for (const char* number : {"-1e308", "1e308", "0"})
        model.value("uno1", "odd", std::string("{\"x\":") + number + "}", start + ++seconds * 1s);
    model.announced("uno1", "odd", std::numeric_limits<int>::max());
    EXPECT_THAT(model.table(start + 4s).render(200, false), HasSubstr(" \u2581\u2588\u2585 "));
}

TEST(TopModel, Records_CarryNumbersForPrograms) {
    constexpr Time kStart{1000s};
    TopModel model(5s);
    model.state("uno1", "online");
    model.value("uno1", "distance", R"({"distance":[42]})", kStart);
    model.round_trip("uno1", 1500us);
    const auto records = model.records(kStart + 500ms);
    ASSERT_EQ(records.size(), 1U);
    EXPECT_EQ(records[0]["service"], "distance");
    EXPECT_DOUBLE_EQ(records[0]["round_trip_ms"], 1.5);
    EXPECT_DOUBLE_EQ(records[0]["age"], 0.5);
    EXPECT_EQ(records[0]["last"]["distance"][0], 42);
}

TEST(TopModel, ValueOlderThanThreePeriods_IsPaintedStale) {
    constexpr Time kStart{1000s};
    TopModel model(5s);
    model.announced("uno1", "distance", 100);
    model.value("uno1", "distance", "{}", kStart);
    EXPECT_THAT(model.table(kStart + 200ms).render(0, true), Not(HasSubstr("\033[31m")));
    EXPECT_THAT(model.table(kStart + 400ms).render(0, true), HasSubstr("\033[31m400 ms"));
}

}  // namespace event_test
}  // namespace asip::cli
