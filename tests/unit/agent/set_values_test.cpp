// SPDX-License-Identifier: Apache-2.0
#include "agent/reports/set_values.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/unit/agent/online_bridge.hpp"

namespace asip::agent {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::IsEmpty;

json vectors() {
    std::ifstream file(ASIP_VECTORS);
    return json::parse(file);
}

TEST(WhatWasSet, OfRequests_IsWhatTheVectorsSay) {
    const auto models = model::ModelSet::standard();
    const auto all = vectors();
    for (const auto& vector : all.at("set")) {
        const auto model = models.find(vector.at("model").get<std::string>());
        ASSERT_TRUE(model) << vector;
        SettingsOfService settings;
        for (const std::string line : vector.at("executed")) {
            const auto request = model::request_values(*model, line.substr(2));
            ASSERT_TRUE(request) << line << ": " << request.error();
            settings.apply(*model, *request, true);
        }
        const auto text = settings.text();
        EXPECT_EQ(text.empty() ? json() : json::parse(text), vector.at("set")) << vector.at("about");
    }
}

TEST(WhatWasSet, ThousandsOfElements_TheNewestStayWithinTheBound) {
    const auto model = model::ModelSet::standard().find("pixels");
    SettingsOfService settings;
    for (int pixel = 0; pixel < 5000; ++pixel) {
        const auto request = model::request_values(*model, "P,1,{" + std::to_string(pixel) + ":16711680}");
        ASSERT_TRUE(request) << request.error();
        settings.apply(*model, *request, true);
    }
    const auto text = settings.text();
    EXPECT_LE(text.size(), SettingsOfService::kMaxBytes);
    EXPECT_GE(text.size(), SettingsOfService::kMaxBytes / 3);
    const auto set = json::parse(text).at("set");
    EXPECT_TRUE(set.contains("4999"));
    EXPECT_FALSE(set.contains("0"));
}

struct SetOfBoard : OnlineBridge {
    std::vector<std::string> said(const std::string& service = "io") const {
        return bench.on("asip/uno1/" + service + "/set");
    }
};

TEST_F(SetOfBoard, CommandExecuted_IsPublishedRetained) {
    EXPECT_EQ(bench.ask("asip/uno1/io/in", {{"write", {13, 1}}})["status"], "ok");
    ASSERT_THAT(said(), ElementsAre(R"({"write":{"13":1}})"));
    for (const auto& publication : bench.published)
        if (publication.message.topic == "asip/uno1/io/set") {
            EXPECT_TRUE(publication.message.retain);
            EXPECT_EQ(publication.message.qos, 1);
        }
}

TEST_F(SetOfBoard, NothingSet_NothingIsPublished) {
    bench.pass(10s);
    EXPECT_THAT(said(), IsEmpty());
    EXPECT_THAT(said("servo"), IsEmpty());
}

TEST_F(SetOfBoard, WhoeverSentIt_IsPublished) {
    bench.hear("asip/uno1/io/in", R"({"write":[13,1]})");
    bench.pass(600ms);
    bench.hear("asip/uno1/in", "I,d,12,1");
    bench.pass(600ms);
    bench.client_says("I,d,11,1");
    bench.pass(600ms);
    EXPECT_THAT(said(), ElementsAre(R"({"write":{"13":1}})", R"({"write":{"12":1,"13":1}})",
                                    R"({"write":{"11":1,"12":1,"13":1}})"));
}

TEST_F(SetOfBoard, RefusedByTheBoard_IsUnchanged) {
    bench.board.replies["I,d,99,1"] = "~I,d,3{INVALID_PIN}";
    bench.ask("asip/uno1/io/in", {{"write", {13, 1}}});
    bench.pass(1s);
    EXPECT_EQ(bench.ask("asip/uno1/io/in", {{"write", {99, 1}}}, "2")["status"], "error");
    EXPECT_EQ(bench.ask("asip/uno1/io/in", {{"write", {13, 7}}}, "3")["status"], "refused");
    bench.pass(2s);
    EXPECT_THAT(said(), ElementsAre(R"({"write":{"13":1}})"));
}

TEST_F(SetOfBoard, ManyCommands_TwiceASecondTheNewestLast) {
    for (int i = 0; i <= 100; ++i) {
        bench.hear("asip/uno1/io/in", R"({"pwm":[3,)" + std::to_string(i) + "]}");
        bench.pass(20ms);
    }
    bench.pass(2s);
    const auto all = said();
    EXPECT_GE(all.size(), 4u);
    EXPECT_LE(all.size(), 6u);
    EXPECT_EQ(all.back(), R"({"pwm":{"3":100}})");
}

TEST_F(SetOfBoard, BoardRestarts_IsCleared) {
    bench.ask("asip/uno1/io/in", {{"write", {13, 1}}});
    bench.say(bench.board.reboot());
    bench.pass(5s);
    EXPECT_EQ(said().back(), "");
    bench.ask("asip/uno1/io/in", {{"write", {12, 1}}}, "2");
    bench.pass(1s);
    EXPECT_EQ(said().back(), R"({"write":{"12":1}})");
}

TEST_F(SetOfBoard, CableOut_IsCleared) {
    bench.ask("asip/uno1/io/in", {{"write", {13, 1}}});
    bench.pass(1s);
    bench.unplug();
    EXPECT_EQ(said().back(), "");
}

TEST_F(SetOfBoard, HoldNotRenewed_IsUndoneThere) {
    bench.ask("asip/uno1/io/in", {{"write", {13, 1}}, {"hold_ms", 1000}});
    EXPECT_EQ(said().back(), R"({"write":{"13":1}})");
    bench.pass(3s);
    EXPECT_EQ(said().back(), R"({"write":{"13":0}})");
}

TEST_F(SetOfBoard, Stopped_IsUndoneThere) {
    bench.ask("asip/uno1/io/in", {{"pwm", {3, 128}}});
    bench.pass(1s);
    bench.hear("asip/uno1/$stop", "");
    bench.pass(1s);
    EXPECT_EQ(said().back(), R"({"pwm":{"3":0}})");
}

TEST_F(SetOfBoard, NoProof_IsNotKnownAnyMore) {
    bench.ask("asip/uno1/io/in", {{"write", {13, 1}}});
    bench.ask("asip/uno1/io/in", {{"write", {12, 1}}}, "2");
    bench.pass(1s);
    bench.board.mute = true;
    bench.hear("asip/uno1/io/in", R"({"write":[13,0],"deadline_ms":1000,"id":"3","reply_to":"answers"})");
    bench.pass(1100ms);
    EXPECT_EQ(said().back(), R"({"write":{"12":1}})") << "it may be on or off";
}

TEST_F(SetOfBoard, BrokerStartedAnew_IsPublishedAgain) {
    bench.ask("asip/uno1/io/in", {{"write", {13, 1}}});
    bench.pass(1s);
    bench.bridge.bus_disconnected();
    bench.client_says("I,d,12,1");
    bench.pass(1s);
    const auto before = said().size();
    bench.connect();
    bench.pass(1s);
    ASSERT_GT(said().size(), before);
    EXPECT_EQ(said().back(), R"({"write":{"12":1,"13":1}})");
}

TEST_F(SetOfBoard, BrokerKeepsWhatAnEarlierAgentSaid_IsCleared) {
    bench.hear("asip/uno1/io/set", R"({"write":{"13":1}})", true);
    bench.hear("asip/uno1/flashed-away/set", R"({"power":{"0":1}})", true);
    bench.pass(1s);
    EXPECT_THAT(said(), ElementsAre(""));
    EXPECT_THAT(said("flashed-away"), ElementsAre(""));
}

TEST_F(SetOfBoard, OthersPublishThere_OnEqualTermsWithNobody) {
    for (int i = 0; i < 1000; ++i)
        bench.hear("asip/uno1/x" + std::to_string(i) + "/set", "{}", true);
    bench.pass(1s);
    std::size_t cleared = 0;
    for (int i = 0; i < 1000; ++i)
        cleared += said("x" + std::to_string(i)).size();
    EXPECT_EQ(cleared, SetValues::kMaxServices) << "bounded";
}

TEST_F(SetOfBoard, AgentEnds_IsCleared) {
    bench.ask("asip/uno1/io/in", {{"write", {13, 1}}});
    Effects out;
    bench.bridge.goodbye(bench.now, out);
    ASSERT_FALSE(out.publish.empty());
    EXPECT_EQ(out.publish.front().message.topic, "asip/uno1/io/set");
    EXPECT_EQ(out.publish.front().message.payload, "");
}

}  // namespace
}  // namespace asip::agent
