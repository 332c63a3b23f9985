// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/agent/online_bridge.hpp"

namespace asip::agent {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

TEST_F(OnlineBridge, AnswersAndErrorsOfAClient_GoToItAlone) {
    bench.board.replies["S,W,9,9"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    bench.client_says("#,?", 1);
    bench.client_says("S,W,9,9", 2);
    bench.client_says("#,E,mine", 3);
    bench.ask("asip/uno1/in", {{"raw", "#,N"}});
    bench.pass(1s);
    EXPECT_THAT(bench.client_lines, IsEmpty());
    ASSERT_EQ(bench.lines_for_one.size(), 3u);
    EXPECT_EQ(bench.lines_for_one[0].line.substr(0, 5), "@#,?,");
    EXPECT_EQ(bench.lines_for_one[0].client, 1u);
    EXPECT_EQ(bench.lines_for_one[1].client, 2u);
    EXPECT_EQ(bench.lines_for_one[2].line, "@#,E,mine");
    EXPECT_EQ(bench.lines_for_one[2].client, 3u);
    bench.say("@D,e,1,{42}\r\n~S,W,7{INVALID_DEVICE_NUMBER}\r\n");
    EXPECT_EQ(bench.client_lines.size(), 2u) << "events, and what nobody asked for, go to all";
}

// What a client is told behind its request is the proof of that.
struct VerifiedBridge : testing::Test {
    VerifiedBridge() {
        bench.board.verified_fences = true;
        bench.go_online();
        bench.lines_for_one.clear();
    }
    std::vector<std::string> lines_for(session::ClientId client) const {
        std::vector<std::string> lines;
        for (const auto& line : bench.lines_for_one)
            if (line.client == client) lines.push_back(line.line);
        return lines;
    }
    BridgeBench bench;
};

TEST_F(VerifiedBridge, AnswerToTheQuestionOfAClient_ComesWhatIsBeforeItWasProven) {
    bench.client_says("I,d,13,1");
    bench.client_says("#,E,mine");
    bench.pass(200ms);
    EXPECT_THAT(lines_for(1), ElementsAre("@#,E,mine"));
    EXPECT_THAT(bench.board.executed, Contains("I,d,13,1"));
}

TEST_F(VerifiedBridge, LineOfAClientIsLost_ItLearnsThatBeforeAnyAnswer) {
    bench.board.misreads["I,d,13,1"] = "I,d,13,0";
    bench.client_says("I,d,13,1", 1);
    bench.client_says("#,E,mine", 1);
    bench.client_says("#,E,other", 2);
    bench.pass(7s);
    ASSERT_FALSE(lines_for(1).empty());
    EXPECT_EQ(lines_for(1).front(), "~#,C,10{BAD_CHECKSUM}");
    bench.lines_for_one.clear();
    bench.client_says("#,E,again", 1);
    bench.pass(200ms);
    EXPECT_THAT(lines_for(1), ElementsAre("@#,E,again"));
}

TEST_F(VerifiedBridge, BoardDiesWithLinesOfAClient_ItLearnsThat) {
    bench.board.mute = true;
    bench.client_says("I,d,13,1", 1);
    bench.pass(10s);
    EXPECT_THAT(lines_for(1), ElementsAre("~#,C,10{BAD_CHECKSUM}"));
}

TEST_F(OnlineBridge, LineOfTheBoardIsDamaged_ClientsWithOpenRequestsLearnThat) {
    bench.board.swallow_fences = 1;
    bench.client_says("#,E,mine", 1);
    bench.say("nonsense\r\n");
    ASSERT_FALSE(bench.lines_for_one.empty());
    EXPECT_EQ(bench.lines_for_one[0].line, "~#,C,10{BAD_CHECKSUM}");
    EXPECT_EQ(bench.lines_for_one[0].client, 1u);
}

TEST_F(OnlineBridge, ClientAsksForExtensions_IsNotOfferedThoseOfTheLine) {
    bench.client_says("#,X", 1);
    ASSERT_EQ(bench.lines_for_one.size(), 1u);
    EXPECT_EQ(bench.lines_for_one[0].line, "@#,X,2,{E:1,I:1}");
    bench.client_says("#,C,1", 1);
    ASSERT_EQ(bench.lines_for_one.size(), 2u);
    EXPECT_EQ(bench.lines_for_one[1].line, "~#,C,2{UNKNOWN_REQUEST}");
}

TEST_F(OnlineBridge, WhatIsNoRequest_IsAnsweredUnderItsLetterAsByTheBoard) {
    for (const auto& [line, answer] :
         std::vector<std::pair<std::string, std::string>>{{"a,?", "~a,?,1{INVALID_SERVICE}"},
                                                          {"5", "~5,?,1{INVALID_SERVICE}"},
                                                          {"Zx", "~Z,?,1{INVALID_SERVICE}"},
                                                          {"#?", "~#,?,2{UNKNOWN_REQUEST}"},
                                                          {"Sx", "~S,?,2{UNKNOWN_REQUEST}"},
                                                          {"Sx,W", "~S,?,2{UNKNOWN_REQUEST}"},
                                                          {"S,", "~S,?,2{UNKNOWN_REQUEST}"},
                                                          {"S,ab", "~S,a,2{UNKNOWN_REQUEST}"},
                                                          {"S,\xe4", "~S,?,2{UNKNOWN_REQUEST}"},
                                                          {"s,W,0,9", "~s,?,1{INVALID_SERVICE}"},
                                                          {"\xc3\xa4,?", "~?,?,1{INVALID_SERVICE}"}}) {
        bench.lines_for_one.clear();
        bench.client_says(line, 1);
        ASSERT_EQ(bench.lines_for_one.size(), 1u) << line;
        EXPECT_EQ(bench.lines_for_one[0].line, answer);
    }
    bench.client_says("#,?", 1);
    EXPECT_EQ(bench.lines_for_one.size(), 2u) << "the next good one works";
}

TEST_F(OnlineBridge, ClientTooFast_IsAskedToWaitAndLosesNothing) {
    bench.board.mute = true;
    int accepted = 0;
    while (bench.client_says("I,d,13,1", 1) == Bridge::ClientResult::kAccepted && accepted < 1000)
        ++accepted;
    EXPECT_LT(accepted, 100);
    EXPECT_EQ(bench.client_says("I,d,13,1", 1), Bridge::ClientResult::kLater);
    EXPECT_EQ(bench.client_says("I,d,13,0", 2), Bridge::ClientResult::kAccepted) << "another client";
    EXPECT_THAT(bench.on("asip/uno1/io/error"), IsEmpty());
}

TEST_F(OnlineBridge, ClientTooFastForASlowBoard_NoMoreWaitThanItExecutesInTime) {
    int waiting = 0;
    bench.board.mute = true;
    while (bench.client_says("S,W,0,90", 1) == Bridge::ClientResult::kAccepted)
        ++waiting;
    EXPECT_LE(waiting, 24) << "five a round trip, and 1.5 s is the longest";
    EXPECT_GE(waiting, 16);
}

TEST_F(OnlineBridge, LineThatWaitedWhileTheAgentWasStopped_IsNotExecuted) {
    EXPECT_EQ(bench.client_says("I,d,13,1", 1, bench.now - 6s), Bridge::ClientResult::kAccepted);
    EXPECT_EQ(bench.client_says("I,d,13,0", 1, bench.now - 4s), Bridge::ClientResult::kAccepted);
    bench.pass(1s);
    EXPECT_THAT(bench.board.executed, ElementsAre("I,d,13,0"));
    ASSERT_FALSE(bench.lines_for_one.empty());
    EXPECT_EQ(bench.lines_for_one[0].line, "~#,C,10{BAD_CHECKSUM}");
}

TEST_F(OnlineBridge, ServiceWithoutAModel_PublishesTagAndBody) {
    bench.board.replies["#,N"] = "@#,N,2,{I:ASIP core IO,Z:A thing}";
    bench.say(bench.board.banner());
    bench.pass(1s);
    bench.say("@Z,e,2,{1,2}\r\n");
    EXPECT_THAT(bench.on("asip/uno1/Z/out"), ElementsAre(R"({"body":"2,{1,2}","tag":"e"})"));
}

TEST_F(OnlineBridge, TwoServicesOfOneKind_BothAreReached) {
    bench.board.replies["#,N"] = "@#,N,3,{I:ASIP core IO,D:Distance,S:Servos}";
    bench.say(bench.board.banner());
    bench.pass(1s);
    const session::ServiceTable table(bench.bridge.session().identity(), model::ModelSet::standard());
    EXPECT_EQ(table.find('D')->name, "distance");
    session::Identity two = bench.bridge.session().identity();
    two.services.push_back({'D', "Distance"});
    const session::ServiceTable both(two, model::ModelSet::standard());
    EXPECT_EQ(both.entries()[1].name, "distance");
    EXPECT_EQ(both.entries()[3].name, "D");
    EXPECT_NE(both.entries()[3].model, nullptr);
}

TEST_F(OnlineBridge, ResponseTopic_IsAnsweredWithTheCorrelationData) {
    mqtt::Message command{.topic = "asip/uno1/servo/in",
                          .payload = R"({"write":[0,90]})",
                          .response_topic = "me",
                          .correlation = std::string("\0\xff", 2)};
    bench.hear(command);
    const auto at = std::find_if(bench.published.begin(), bench.published.end(),
                                 [](const auto& p) { return p.message.topic == "me"; });
    ASSERT_NE(at, bench.published.end());
    EXPECT_EQ(at->message.correlation, command.correlation);
    EXPECT_EQ(at->priority, mqtt::Priority::kReply);
}

TEST_F(OnlineBridge, BoardNotThere_IsRefusedAndWhatWasSentTimesOut) {
    bench.board.mute = true;
    bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, "sent");
    bench.unplug();
    EXPECT_EQ(json::parse(bench.on("answers").back())["status"], "timeout");
    EXPECT_EQ(bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, "after")["reason"], "board-not-there");
}

TEST_F(OnlineBridge, QueueFull_IsRefusedAndEveryCommandIsAnsweredOnce) {
    bench.board.mute = true;
    for (int i = 0; i < 2000; ++i)
        bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, "n" + std::to_string(i));
    EXPECT_GE(bench.on("answers").size(), 1400u);
    EXPECT_EQ(json::parse(bench.on("answers").back())["reason"], "queue-full");
    bench.unplug();
    EXPECT_EQ(bench.on("answers").size(), 2000u);
}

TEST_F(OnlineBridge, LineOfAClient_ReachesTheBoardAndBadOnesDoNot) {
    EXPECT_EQ(bench.client_says("I,d,13,1"), Bridge::ClientResult::kAccepted);
    EXPECT_EQ(bench.client_says("#,B,500000"), Bridge::ClientResult::kRefused);
    EXPECT_EQ(bench.client_says("nonsense"), Bridge::ClientResult::kRefused);
    EXPECT_THAT(bench.board.executed, ElementsAre("I,d,13,1"));
}

}  // namespace
}  // namespace asip::agent
