// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/agent/bridge_bench.hpp"
#include "tests/unit/agent/online_bridge.hpp"

namespace asip::agent {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST(NoAnswer, NoBoardEverIdentified_EndsTheProgram) {
    BridgeBench bench;
    bench.board.mute = true;
    bench.plug();
    bench.pass(10s);
    ASSERT_TRUE(bench.fatal);
    EXPECT_EQ(bench.fatal->status, 5);
    EXPECT_THAT(bench.fatal->text, HasSubstr("does not answer"));
}

TEST(NoAnswer, BehindTcp_IsToldInWordsOfTcp) {
    for (const std::string bytes : {"", "HTTP/1.1 400 Bad Request\r\n\r\n"}) {
        BridgeBench bench;
        bench.board.mute = true;
        bench.run(
            [&](Effects& out) { bench.bridge.link_up({0, false}, {"tcp", "pi:6789", 0}, bench.now, out); });
        for (int i = 0; i < 20; ++i) {
            if (!bytes.empty()) bench.say(bytes);
            bench.pass(1s);
        }
        ASSERT_TRUE(bench.fatal);
        EXPECT_THAT(bench.fatal->text, HasSubstr("pi:6789"));
        EXPECT_THAT(bench.fatal->text, AllOf(HasSubstr("HOST:PORT/frames"), HasSubstr("HOST:PORT/lines")));
        EXPECT_THAT(bench.fatal->text, HasSubstr(bytes.empty() ? "does not answer" : "sends bytes"));
        EXPECT_THAT(bench.fatal->text, testing::Not(testing::AnyOf(HasSubstr("baud"), HasSubstr("fuser"))));
    }
}

TEST(NoAnswer, BoardSaidItsBannerAndNothingElse_IsCalledABoard) {
    BridgeBench bench;
    bench.board.mute = true;
    bench.plug();
    bench.say(bench.board.banner());
    bench.pass(20s);
    ASSERT_TRUE(bench.fatal);
    EXPECT_THAT(bench.fatal->text, HasSubstr("said that it is an ASIP board, and answers no question"));
}

TEST_F(OnlineBridge, ReplacedByABoardThatIsMute_WarnsAndKeepsAsking) {
    bench.unplug();
    bench.board.mute = true;
    bench.plug();
    bench.pass(60s);
    EXPECT_FALSE(bench.fatal);
    EXPECT_EQ(std::count_if(bench.notices.begin(), bench.notices.end(),
                            [](const auto& n) { return n.find("does not answer") != n.npos; }),
              1);
    bench.board.mute = false;
    bench.pass(10s);
    EXPECT_EQ(bench.on("asip/servicebus/uno1/$state").back(), "online");
}

TEST_F(OnlineBridge, SilentForLongWithoutUnplugging_IsNeverFatal) {
    bench.board.mute = true;
    bench.pass(60s);
    EXPECT_FALSE(bench.fatal);
    EXPECT_EQ(bench.on("asip/servicebus/uno1/$state").back(), "lost");
    bench.board.mute = false;
    bench.pass(10s);
    EXPECT_EQ(bench.on("asip/servicebus/uno1/$state").back(), "online");
}

TEST_F(OnlineBridge, EventOfTheBoard_IsPublishedRawAndDecoded) {
    bench.say("@D,e,2,{42,118}\r\n");
    EXPECT_THAT(bench.on("asip/uno1/out"), ElementsAre("@D,e,2,{42,118}"));
    EXPECT_THAT(bench.on("asip/uno1/distance/out"), ElementsAre(R"({"distance":[42,118]})"));
    EXPECT_THAT(bench.client_lines, ElementsAre("@D,e,2,{42,118}"));
}

TEST_F(OnlineBridge, DigitalEvent_NamesThePinsOfThePort) {
    bench.say("@I,d,4,4\r\n");
    ASSERT_EQ(bench.on("asip/uno1/io/out").size(), 1u);
    EXPECT_EQ(json::parse(bench.on("asip/uno1/io/out")[0])["digital"]["2"], 1);
}

TEST_F(OnlineBridge, ErrorOfTheBoard_IsPublishedForItsService) {
    bench.say("~S,W,7{INVALID_DEVICE_NUMBER}\r\n");
    ASSERT_EQ(bench.on("asip/uno1/servo/error").size(), 1u);
    EXPECT_EQ(json::parse(bench.on("asip/uno1/servo/error")[0]),
              json::parse(R"({"request":"W","code":7,"error":"INVALID_DEVICE_NUMBER"})"));
}

TEST_F(OnlineBridge, EventThatFitsNoModel_IsPublishedRawOnly) {
    bench.say("@D,e,3,{42\r\n@Z,z,1\r\n");
    EXPECT_EQ(bench.on("asip/uno1/out").size(), 2u);
    EXPECT_EQ(bench.published.size(), 2u);
}

TEST_F(OnlineBridge, ElementsSeen_AreCountedInTheDescription) {
    bench.say("@D,e,2,{42,118}\r\n");
    bench.pass(1s);
    const auto descriptions = bench.on("asip/servicebus/uno1/$description");
    ASSERT_EQ(descriptions.size(), 1u);
    EXPECT_EQ(model::parse_description(descriptions[0])->service("distance")->count, 2);
}

TEST_F(OnlineBridge, ModeAndPeriodSet_AreInTheDescription) {
    bench.ask("asip/uno1/io/in", {{"mode", {3, "output"}}}, "1");
    bench.ask("asip/uno1/distance/in", {{"report", 100}}, "2");
    bench.pass(1s);
    const auto descriptions = bench.on("asip/servicebus/uno1/$description");
    ASSERT_EQ(descriptions.size(), 1u) << "one announcement for both";
    const auto description = model::parse_description(descriptions[0]);
    EXPECT_EQ(description->pins.modes, "661377");
    EXPECT_EQ(description->service("distance")->period, 100);
}

TEST_F(OnlineBridge, BusAway_NewestValueOfEachKindIsPublishedWhenItIsBack) {
    bench.bridge.bus_disconnected();
    for (const char* line : {"@D,e,1,{1}\n", "@I,d,4,4\n", "@D,e,1,{2}\n", "@I,d,3,0\n", "@D,e,1,{3}\n"})
        bench.say(line);
    EXPECT_THAT(bench.on("asip/uno1/out"), IsEmpty());
    bench.connect();
    EXPECT_THAT(bench.on("asip/uno1/out"), ElementsAre("@D,e,1,{3}", "@I,d,3,0", "@I,d,4,4"));
}

TEST(Claim, NameNotYetOurs_NothingIsPublishedOrExecuted) {
    BridgeBench bench;
    bench.plug();
    bench.connect();
    bench.board.executed.clear();
    bench.say("@D,e,1,{42}\n");
    bench.hear("asip/uno1/in", "I,d,13,1");
    EXPECT_THAT(bench.on("asip/uno1/out"), IsEmpty());
    EXPECT_THAT(bench.board.executed, IsEmpty());
    bench.pass(1500ms);
    EXPECT_THAT(bench.on("asip/uno1/out"), ElementsAre("@D,e,1,{42}"));
}

TEST(Context, TerminatorAndRetainWanted_AreUsed) {
    auto options = BridgeBench::defaults();
    options.context = {"\r\n", true};
    OnlineBench bench(options);
    bench.say("@D,e,1,{42}\r\n");
    EXPECT_THAT(bench.on("asip/uno1/out"), ElementsAre("@D,e,1,{42}\r\n"));
    bool retained = false;
    for (const auto& p : bench.published)
        retained = retained || (p.message.topic == "asip/uno1/distance/out" && p.message.retain);
    EXPECT_TRUE(retained);
}

struct ClientSideTopics : testing::Test {
    ClientSideTopics() : bench(options()) {
        bench.go_online();
        bench.published.clear();
        bench.board.executed.clear();
    }
    static BridgeOptions options() {
        auto options = BridgeBench::defaults();
        options.context = {"\n", false, true};
        return options;
    }
    BridgeBench bench;
};

TEST_F(ClientSideTopics, RawLines_GoTheOtherWayRound) {
    EXPECT_THAT(bench.bridge.control_subscriptions(),
                Contains(testing::Field(&member::Announcer::Subscription::filter, "asip/uno1/out")));
    bench.say("@D,e,1,{42}\r\n");
    EXPECT_THAT(bench.on("asip/uno1/in"), ElementsAre("@D,e,1,{42}\n"));
    EXPECT_THAT(bench.on("asip/uno1/out"), IsEmpty());
    EXPECT_THAT(bench.on("asip/uno1/distance/out"), SizeIs(1));
    bench.hear("asip/uno1/out", "S,W,0,90\n");
    EXPECT_THAT(bench.board.executed, ElementsAre("S,W,0,90"));
}

TEST_F(ClientSideTopics, LineOnIn_IsExecutedOnlyWhereAnAnswerIsWanted) {
    // Our own lines come back from brokers that speak 3.1.1.
    for (const char* line : {"S,W,0,90", "@D,e,1,{42}\n", R"({"raw":"S,W,0,90"})", "{", ""})
        bench.hear("asip/uno1/in", line);
    EXPECT_THAT(bench.board.executed, IsEmpty());
    EXPECT_THAT(bench.published, IsEmpty());
    bench.hear("asip/uno1/in", R"({"raw":"S,W,0,90","id":"1","reply_to":"me"})");
    EXPECT_THAT(bench.board.executed, Contains("S,W,0,90"));
    EXPECT_THAT(bench.on("me"), SizeIs(1));
}

TEST_F(ClientSideTopics, RetainedRequestOnOut_IsRefused) {
    bench.hear("asip/uno1/out", "S,W,0,90", true);
    EXPECT_THAT(bench.board.executed, IsEmpty());
    EXPECT_THAT(bench.on("asip/uno1/io/error"), SizeIs(1));
}

TEST_F(OnlineBridge, LineOnOut_IsNoRequest) {
    bench.hear("asip/uno1/out", "S,W,0,90");
    EXPECT_THAT(bench.board.executed, IsEmpty());
}

TEST_F(OnlineBridge, ForeignTopics_ChangeNothing) {
    for (const char* topic : {"asip/other/in", "asip/uno1/bad name/in", "x", "", "asip/uno1/io/in/more"})
        bench.hear(topic, "S,W,0,90");
    EXPECT_THAT(bench.published, IsEmpty());
}

}  // namespace
}  // namespace asip::agent
