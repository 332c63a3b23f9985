// SPDX-License-Identifier: Apache-2.0
#include "cli/events/decoded_event.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "asip/model/model_set.hpp"
#include "asip/property/list.hpp"
#include "asip/protocol/pin.hpp"
#include "cli/events/button_events.hpp"
#include "cli/events/event_pace.hpp"
#include "tests/unit/cli/boards.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;
using ::testing::IsEmpty;
using ::testing::SizeIs;

ContextEvent report(const std::string& service, const std::string& payload) {
    return *context_event(bus::Topics("asip"), "asip/uno1/" + service + "/out", payload);
}

std::string said(const std::string& service, const std::string& payload, const std::string& field = {},
                 const std::vector<property::Property>& properties = {}) {
    const auto model = model::ModelSet::standard().find(service);
    const auto decoded = decode_event(report(service, payload), model.get(), properties, field);
    return decoded ? decoded->text : "nothing";
}

TEST(DecodeEvent, Values_StandWithTheUnitOfTheirModel) {
    EXPECT_EQ(said("distance", R"({"distance":[42,118]})"), "distance 42 cm, 118 cm");
    EXPECT_EQ(said("distance", R"({"distance":[]})"), "distance ");
    EXPECT_EQ(said("io", R"({"digital":{"2":1}})"), "digital 1");
    EXPECT_EQ(said("io", R"({"digital":{"2":1,"3":0}})"), "digital 2=1 3=0");
    EXPECT_EQ(said("distance", R"({"new":[1]})"), "new [1]") << "of a later version";
}

TEST(DecodeEvent, ValuesOfProperties_HaveTheirWords) {
    auto board = *model::parse_description(kUno1);
    board.labels.modes[2] = static_cast<int>(protocol::PinMode::kInputPullup);
    board.labels.meanings["io/2"].klass = "button";
    board.labels.meanings["distance/0"].line = {0, 100, 0, 1};
    board.labels.meanings["distance/0"].unit = "m";
    const auto properties = property::properties_of(board, [](const model::ServiceInfo& service) {
        return model::ModelSet::standard().find(service.name);
    });
    EXPECT_EQ(said("io", R"({"digital":{"2":0,"3":0}})", {}, properties), "digital 2=pressed 3=0");
    EXPECT_EQ(said("io", R"({"digital":{"2":1}})", "digital/2", properties), "digital/2 released");
    EXPECT_EQ(said("distance", R"({"distance":[42,0]})", {}, properties), "distance 0.42 m, none");
    EXPECT_EQ(said("distance", R"({"distance":[99999,7]})", {}, properties), "distance 99999 cm, 7 cm")
        << "a number that the property cannot have is shown as it came";
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
    auto decoded = *decode_event(event, nullptr, {}, {});
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

mqtt::Message values_of(const std::string& events, int seq, bool retained = false) {
    return mqtt::Message{
        .topic = "asip/uno1/$values",
        .payload = R"({"version":1,"board":"uno1","session":"s1","seq":)" + std::to_string(seq) +
                   R"(,"values":{"io/2":{"value":true,"how":"reported","age":0,"events":)" + events + "}}}",
        .retain = retained};
}

TEST(ButtonEvents, EachIsTakenOnce_AndNoneThatTheBrokerKept) {
    const bus::Topics topics("asip");
    ButtonEvents buttons(topics);
    EXPECT_THAT(buttons.take(values_of(R"([[4,"press"]])", 1, true)), IsEmpty());
    const auto events = buttons.take(values_of(R"([[4,"press"],[5,"hold"]])", 2));
    ASSERT_THAT(events, SizeIs(1));
    EXPECT_EQ(events[0].where(), "uno1/io");
    EXPECT_EQ(decode_event(events[0], nullptr, {}, "")->text, "button 2 hold");
    EXPECT_EQ(event_json(events[0])["button"]["io/2"], "hold");
    EXPECT_THAT(buttons.take(values_of(R"([[5,"hold"]])", 3)), IsEmpty());
    auto odd = values_of("[7]", 4);
    EXPECT_THAT(buttons.take(odd), IsEmpty());
    EXPECT_THAT(buttons.take(values_of(R"([[6,"release"]])", 5)), SizeIs(1)) << "the next one works";
    EventPace pace(true, 1);
    for (int i = 0; i < 3; ++i)
        EXPECT_TRUE(pace.offer({events[0], *decode_event(events[0], nullptr, {}, "")}, kStart))
            << "each counts";
}

TEST(EventPace, Errors_PassAlways) {
    EventPace pace(true, 1);
    const auto event = *context_event(bus::Topics("asip"), "asip/uno1/servo/error", "{}");
    for (int i = 0; i < 3; ++i)
        EXPECT_TRUE(pace.offer({event, *decode_event(event, nullptr, {}, "0")}, kStart));
}

}  // namespace
}  // namespace asip::cli
