// SPDX-License-Identifier: Apache-2.0
#include "cli/events/decoded_event.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asip/model/model_set.hpp"
#include "cli/events/event_pace.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;
using ::testing::IsEmpty;
using ::testing::SizeIs;

ContextEvent report(const std::string& service, const std::string& payload) {
    return *context_event(bus::Topics("asip"), "asip/uno1/" + service + "/out", payload);
}

std::string said(const std::string& service, const std::string& payload, const std::string& field = {}) {
    const auto model = model::ModelSet::standard().find(service);
    const auto decoded = decode_event(report(service, payload), model.get(), field);
    return decoded ? decoded->text : "nothing";
}

TEST(DecodeEvent, Values_StandWithTheUnitOfTheirModel) {
    EXPECT_EQ(said("distance", R"({"distance":[42,118]})"), "distance 42, 118 cm");
    EXPECT_EQ(said("distance", R"({"distance":[]})"), "distance ");
    EXPECT_EQ(said("io", R"({"digital":{"2":1}})"), "digital 1");
    EXPECT_EQ(said("io", R"({"digital":{"2":1,"3":0}})"), "digital 2=1 3=0");
    EXPECT_EQ(said("distance", R"({"new":[1]})"), "new [1]") << "of a later version";
}

TEST(DecodeEvent, WithoutModelOrDocument_IsShownAsItCame) {
    EXPECT_EQ(said("X", R"({"tag":"k","body":"7"})"), R"({"tag":"k","body":"7"})");
    EXPECT_EQ(said("distance", "no json"), "no json");
    EXPECT_EQ(said("distance", "[1]"), "[1]");
}

TEST(DecodeEvent, Field_IsPickedOutOrTheReportIsNotMeant) {
    EXPECT_EQ(said("distance", R"({"distance":[42,118]})", "1"), "distance/1 118 cm");
    EXPECT_EQ(said("distance", R"({"distance":[42,118]})", "distance"), "distance 0=42 cm 1=118 cm");
    EXPECT_EQ(said("io", R"({"analog":{"0":3}})", "digital"), "nothing");
    EXPECT_EQ(said("distance", R"({"distance":[42]})", "5"), "nothing");
    EXPECT_EQ(said("distance", "no json", "0"), "nothing");
    EXPECT_EQ(said("X", R"({"tag":"k","a":[7]})", "a/0"), "a/0 7");
    EXPECT_EQ(said("X", R"({"tag":"k"})", "a/0"), "nothing");
}

SeenEvent seen(const std::string& payload) {
    auto event = report("distance", payload);
    auto decoded = *decode_event(event, nullptr, {});
    return {std::move(event), std::move(decoded)};
}

constexpr Time kStart{1000s};

TEST(EventPace, Changes_AreShownOnceEach) {
    EventPace pace(true, 0);
    EXPECT_TRUE(pace.offer(seen(R"({"distance":[1]})"), kStart));
    EXPECT_FALSE(pace.offer(seen(R"({"distance":[1]})"), kStart));
    EXPECT_TRUE(pace.offer(seen(R"({"other":[1]})"), kStart)) << "another kind of report";
    EXPECT_FALSE(pace.offer(seen(R"({"distance":[1]})"), kStart));
    EXPECT_TRUE(pace.offer(seen(R"({"distance":[2]})"), kStart));
}

TEST(EventPace, TooManyASecond_TheNewestIsNotLost) {
    EventPace pace(false, 2);
    EXPECT_TRUE(pace.offer(seen(R"({"distance":[1]})"), kStart));
    EXPECT_FALSE(pace.offer(seen(R"({"distance":[2]})"), kStart + 100ms));
    EXPECT_FALSE(pace.offer(seen(R"({"distance":[3]})"), kStart + 200ms));
    EXPECT_THAT(pace.due(kStart + 499ms), IsEmpty());
    const auto due = pace.due(kStart + 500ms);
    ASSERT_THAT(due, SizeIs(1));
    EXPECT_EQ(due[0].event.payload, R"({"distance":[3]})");
    EXPECT_THAT(pace.due(kStart + 2s), IsEmpty());
    EXPECT_FALSE(pace.offer(seen(R"({"distance":[4]})"), kStart + 600ms));
    EXPECT_TRUE(pace.offer(seen(R"({"distance":[5]})"), kStart + 1100ms)) << "in place of the one that waits";
    EXPECT_THAT(pace.due(kStart + 5s), IsEmpty());
}

TEST(EventPace, Errors_PassAlways) {
    EventPace pace(true, 1);
    const auto event = *context_event(bus::Topics("asip"), "asip/uno1/servo/error", "{}");
    for (int i = 0; i < 3; ++i)
        EXPECT_TRUE(pace.offer({event, *decode_event(event, nullptr, "0")}, kStart));
}

}  // namespace
}  // namespace asip::cli
