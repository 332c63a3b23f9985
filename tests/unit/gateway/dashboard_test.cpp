// SPDX-License-Identifier: Apache-2.0
// What a dashboard may be, what its widgets read and send, and how it is kept on the bus.
#include <gmock/gmock.h>

#include "clock.hpp"
#include "gateway/api/openapi_schemas.hpp"
#include "gateway/dashboard/dashboards.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

std::string with(const std::string& widget) {
    return R"({"title":"Lab","widgets":[)" + widget + "]}";
}
std::string fault_of(const std::string& text) {
    const auto parsed = parse_dashboard(text);
    return parsed ? std::string() : parsed.error();
}
Widget widget(const std::string& text) {
    const auto parsed = parse_dashboard(with(text));
    if (!parsed) throw std::runtime_error(parsed.error());
    return parsed->widgets.front();
}

TEST(Dashboard, ExampleOfTheDocument_IsReadAndKeptAsItIs) {
    const auto parsed = parse_dashboard(api::kDashboardExample);
    ASSERT_TRUE(parsed) << parsed.error();
    ASSERT_EQ(parsed->widgets.size(), 8u);
    EXPECT_EQ(parsed->widgets[0].id, "w1");
    EXPECT_THAT(parsed->boards(), ElementsAre("desk", "lamp"));
    auto again = *parsed;
    again.links.push_back(
        {"hall", "ab", "ann", "0123456789abcdef", true, text::parse_iso_time("2027-01-31T00:00:00.000Z")});
    const auto kept = parse_kept_dashboard(kept_text(again));
    ASSERT_TRUE(kept) << kept.error();
    EXPECT_EQ(kept_text(*kept), kept_text(again));
    EXPECT_EQ(etag_of(*kept), etag_of(*parsed)) << "a link is no change of what is shown";
    EXPECT_FALSE(to_json(*kept).dump().find("hash") != std::string::npos);
}

TEST(Dashboard, Faults_AreNamedWithTheirPlace) {
    EXPECT_THAT(fault_of("{"), HasSubstr("not JSON"));
    EXPECT_THAT(fault_of("[]"), HasSubstr("must be an object"));
    EXPECT_THAT(fault_of("{}"), HasSubstr("widgets must be an array"));
    EXPECT_THAT(fault_of(R"({"widget":[]})"), HasSubstr("no member \"widget\""));
    EXPECT_THAT(fault_of(with("7")), HasSubstr("widget 1: must be an object"));
    EXPECT_THAT(fault_of(with("{}")), HasSubstr("widget 1: kind is missing: value, plot"));
    EXPECT_THAT(fault_of(with(R"({"kind":"lamb"})")), HasSubstr("did you mean \"lamp\"?"));
    EXPECT_THAT(fault_of(with(R"({"kind":"stop","colour":"red"})")), HasSubstr("no member \"colour\""));
    EXPECT_THAT(fault_of(with(R"({"kind":"value","board":"a b","property":"io/2"})")),
                HasSubstr("board: \"a b\" is not a name"));
    EXPECT_THAT(fault_of(with(R"({"kind":"value","board":"a"})")), HasSubstr("property is missing"));
    EXPECT_THAT(fault_of(with(R"({"kind":"lamp","board":"a","property":"/x"})")), HasSubstr("is no id"));
    EXPECT_THAT(fault_of(with(R"({"kind":"lamp","labels":"-a","property":"io/2"})")), HasSubstr("labels: "));
    EXPECT_THAT(fault_of(with(R"({"kind":"lamp","labels":"a","board":"a","property":"io/2"})")),
                HasSubstr("exclude each other"));
    EXPECT_THAT(fault_of(with(R"({"kind":"plot","board":"a","property":"io/2","span":"days"})")),
                HasSubstr("did you mean \"day\"?"));
    EXPECT_THAT(fault_of(with(R"({"kind":"plot","board":"a","property":"io/2","span":86400})")),
                HasSubstr("span must be a text"));
    EXPECT_THAT(fault_of(with(R"({"kind":"value","board":"a","property":"io/2","span":"day"})")),
                HasSubstr("span is that of a plot"));
    EXPECT_THAT(fault_of(with(R"({"kind":"text"})")), HasSubstr("text is missing"));
    EXPECT_THAT(fault_of(with(R"({"kind":"text","text":")" + std::string(1001, 'x') + "\"}")),
                HasSubstr("at most 1000 bytes"));
    EXPECT_THAT(fault_of(with(R"({"kind":"stop","id":"a"},{"kind":"stop","id":"a"})")),
                HasSubstr("two have the id a"));
    EXPECT_THAT(fault_of(R"({"title":7,"widgets":[]})"), HasSubstr("title must be a text"));
    std::string many;
    for (int i = 0; i < 49; ++i)
        many += std::string(i > 0 ? "," : "") + R"({"kind":"stop"})";
    EXPECT_THAT(fault_of(with(many)), HasSubstr("at most 48"));
    EXPECT_THAT(fault_of(with(R"({"kind":"stop","title":")" + std::string(20'000, 'x') + "\"}")),
                HasSubstr("not JSON"));
    for (const auto* name : {"in", "out", "error", "set", "a b", "", "a/b", ".."})
        EXPECT_FALSE(valid_dashboard_name(name)) << name;
    EXPECT_TRUE(valid_dashboard_name("lab-1"));
}

TEST(Dashboard, OfALight_SwitchAndSliderSetTheirPart) {
    const auto made = widget(R"({"kind":"switch","board":"a","property":"io/13"})");
    EXPECT_EQ(made.service(), "io");
    property::Property lamp;
    EXPECT_EQ(property::value_of_control(lamp, true), json(true));
    lamp.kind = property::Kind::kLight;
    EXPECT_EQ(property::value_of_control(lamp, true), (json{{"on", true}}));
    EXPECT_EQ(property::value_of_control(lamp, 0), (json{{"on", false}}));
    EXPECT_EQ(property::value_of_control(lamp, 128), (json{{"on", true}, {"brightness", 128}}));
}

/// Its messages go to a broker that keeps them, and sends them to all.
class KeptDashboards : public testing::Test {
  protected:
    Dashboards::Port port() {
        return {[this](mqtt::Message message) {
                    sent_.push_back(std::move(message));
                    return !full_;
                },
                [this] { ++changes_; }, [this](const std::string& sentence) { logged_.push_back(sentence); }};
    }
    static mqtt::Message message(const std::string& name, const std::string& payload) {
        return mqtt::Message{.topic = "asip/export/dashboard/" + name, .payload = payload};
    }
    static Dashboard titled(const std::string& title) {
        Dashboard dashboard;
        dashboard.title = title;
        return dashboard;
    }
    void read(const std::vector<std::string>& names) {
        all_.subscribed();
        for (const auto& name : names)
            all_.take(message(name, R"({"title":"T","widgets":[]})"));
        all_.complete();
    }
    Dashboards::Done told(const std::string& what) {
        return [this, what](const std::string& error) { told_.push_back(what + ": " + error); };
    }
    void echo() {
        for (const auto& each : std::exchange(sent_, {}))
            all_.take(each);
    }

    std::vector<mqtt::Message> sent_;
    std::vector<std::string> logged_, told_;
    int changes_ = 0;
    bool full_ = false;
    Dashboards all_{"asip", port()};
};

TEST_F(KeptDashboards, Write_CountsOnceTheBrokerHasSentItBack) {
    read({});
    all_.write("lab", titled("Lab"), at(0s).time, told("made"));
    EXPECT_EQ(all_.find("lab"), nullptr);
    EXPECT_TRUE(all_.busy("lab"));
    ASSERT_EQ(sent_.size(), 1u);
    EXPECT_TRUE(sent_[0].retain);
    EXPECT_EQ(sent_[0].qos, 1);
    echo();
    EXPECT_THAT(told_, ElementsAre("made: "));
    ASSERT_NE(all_.find("lab"), nullptr);
    all_.write("lab", std::nullopt, at(0s).time, told("removed"));
    echo();
    EXPECT_EQ(all_.find("lab"), nullptr);
    EXPECT_THAT(told_, ElementsAre("made: ", "removed: "));
}

TEST_F(KeptDashboards, WriteThatTheBrokerDoesNotKeep_IsAFault) {
    read({});
    all_.write("lab", titled("Lab"), at(0s).time, told("denied"));
    all_.tick(at(4s).time);
    EXPECT_TRUE(told_.empty());
    all_.tick(at(5s).time);
    full_ = true;
    all_.write("lab", titled("Lab"), at(6s).time, told("full"));
    full_ = false;
    all_.disconnected();
    all_.write("lab", titled("Lab"), at(6s).time, told("away"));
    ASSERT_EQ(told_.size(), 3u);
    EXPECT_THAT(told_[0], HasSubstr("may this gateway write to asip/export/dashboard/lab?"));
    EXPECT_THAT(told_[1], HasSubstr("too much waits"));
    EXPECT_THAT(told_[2], HasSubstr("not connected"));
    EXPECT_FALSE(all_.busy("lab"));
}

TEST_F(KeptDashboards, BrokerThatForgotAll_IsGivenThemAgain) {
    read({"lab", "hall"});
    all_.disconnected();
    read({});
    ASSERT_EQ(sent_.size(), 2u);
    EXPECT_EQ(sent_[0].topic, "asip/export/dashboard/hall");
    EXPECT_NE(all_.find("lab"), nullptr);
    sent_.clear();
    all_.disconnected();
    read({"lab"});
    EXPECT_TRUE(sent_.empty());
    EXPECT_EQ(all_.find("hall"), nullptr) << "it was removed meanwhile";
}

TEST_F(KeptDashboards, RetainedOnesMayComeAheadOfTheAnswerToTheSubscription) {
    const auto read_early = [this](const std::vector<std::string>& names) {
        for (const auto& name : names)
            all_.take(message(name, R"({"title":"T","widgets":[]})"));
        all_.complete();
        all_.subscribed();
        all_.complete();
        all_.subscribed();  // to something else, too
        all_.complete();
    };
    read_early({"lab", "hall"});
    EXPECT_TRUE(sent_.empty()) << "the broker has them";
    all_.disconnected();
    all_.complete();
    EXPECT_EQ(all_.all().size(), 2u) << "they are shown while the broker is away";
    read_early({"lab"});
    EXPECT_TRUE(sent_.empty()) << "one was removed meanwhile, and is not brought back";
    EXPECT_EQ(all_.find("hall"), nullptr);
    EXPECT_NE(all_.find("lab"), nullptr);
}

/// A gateway that was away must not bring back what was removed meanwhile: its links would work again.
TEST_F(KeptDashboards, LastOneIsRemovedWhileAGatewayIsAway_StaysRemoved) {
    read({"lab"});
    Dashboards away{"asip", port()};
    away.subscribed();
    away.take(message("lab", R"({"title":"T","widgets":[]})"));
    away.complete();
    away.disconnected();
    all_.write("lab", std::nullopt, at(0s).time, told("removed"));
    ASSERT_EQ(sent_.size(), 1u);
    const auto retained = sent_[0];
    echo();
    EXPECT_TRUE(all_.all().empty());
    EXPECT_TRUE(logged_.empty());
    away.subscribed();
    if (!retained.payload.empty()) away.take(retained);
    away.complete();
    EXPECT_TRUE(sent_.empty()) << "nothing is given to the broker again";
    EXPECT_TRUE(away.all().empty());
    EXPECT_TRUE(away.has_room());
    away.write("hall", titled("Hall"), at(1s).time, told("made"));
    ASSERT_EQ(sent_.size(), 2u);
    EXPECT_EQ(sent_[1].topic, "asip/export/dashboard/lab");
    EXPECT_EQ(sent_[1].payload, "") << "where there is another one, nothing is kept of it";
    sent_.clear();
    away.take(message("lab", ""));
    away.take(message("hall", R"({"widgets":[]})"));
    away.take(message("lab", R"({"widgets":[]})"));
    away.write("lab", std::nullopt, at(2s).time, told("removed"));
    ASSERT_EQ(sent_.size(), 1u);
    EXPECT_EQ(sent_[0].payload, "") << "it is not the last one";
}

TEST_F(KeptDashboards, WhatOthersWrite_IsBoundedAndReadWithCare) {
    read({});
    EXPECT_FALSE(all_.known() && all_.take(mqtt::Message{}));
    EXPECT_TRUE(all_.take(message("out", R"({"widgets":[]})"))) << "a board called export reports";
    EXPECT_TRUE(all_.all().empty());
    all_.take(message("lab", R"({"widgets":[]})"));
    const auto version = all_.version();
    all_.take(message("lab", "rubbish"));
    EXPECT_EQ(all_.find("lab"), nullptr);
    EXPECT_GT(all_.version(), version);
    ASSERT_EQ(logged_.size(), 1u);
    EXPECT_THAT(logged_[0], HasSubstr("dashboard lab cannot be read"));
    for (int i = 0; i < 70; ++i)
        all_.take(message("d" + std::to_string(i), R"({"widgets":[]})"));
    EXPECT_EQ(all_.all().size(), Dashboards::kMax);
    EXPECT_EQ(logged_.size(), 2u) << "said once";
    EXPECT_FALSE(all_.has_room());
    all_.take(message("d0", ""));
    EXPECT_TRUE(all_.has_room());
}

TEST_F(KeptDashboards, Links_HoldAsLongAsTheyAreKept) {
    read({});
    all_.take(
        message("lab", R"({"widgets":[],"links":[{"name":"hall","hash":"ab","by":"ann","control":true}]})"));
    const auto rights = all_.link_of("ab");
    ASSERT_TRUE(rights);
    EXPECT_EQ(rights->name, "hall@lab");
    EXPECT_TRUE(rights->control);
    EXPECT_TRUE(rights->limited());
    EXPECT_FALSE(rights->sees_board("desk"));
    EXPECT_FALSE(rights->sees_service("desk", "io"));
    EXPECT_TRUE(all_.holds(*rights));
    EXPECT_FALSE(all_.link_of("cd"));
    all_.take(
        message("lab", R"({"widgets":[],"links":[{"name":"hall","hash":"ab","by":"ann","control":false}]})"));
    EXPECT_FALSE(all_.holds(*rights)) << "it allows something else now";
    all_.take(
        message("lab", R"({"widgets":[],"links":[{"name":"hall","hash":"cd","by":"ann","control":true}]})"));
    EXPECT_FALSE(all_.holds(*rights)) << "another link has its name now";
    all_.take(message("lab", R"({"widgets":[]})"));
    EXPECT_FALSE(all_.link_of("ab"));
}

}  // namespace
}  // namespace asip::gateway
