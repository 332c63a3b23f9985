// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/agent/online_bridge.hpp"

namespace asip::agent {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::IsEmpty;

struct SilentSender : OnlineBridge {
    json error(const std::string& service, std::size_t at = 0) {
        const auto errors = bench.on("asip/uno1/" + service + "/error");
        return at < errors.size() ? json::parse(errors[at]) : json();
    }
};

TEST_F(SilentSender, InvalidCommand_IsReportedOnTheErrorTopicOfItsService) {
    bench.hear("asip/uno1/servo/in", R"({"write":[0,900]})");
    EXPECT_EQ(error("servo")["request"], R"({"write":[0,900]})");
    EXPECT_EQ(error("servo")["reason"], "invalid");
    EXPECT_FALSE(error("servo")["error"].get<std::string>().empty());
    bench.hear("asip/uno1/servo/in", R"({"write":[0,90)");
    EXPECT_EQ(error("servo", 1)["reason"], "invalid");
}

TEST_F(SilentSender, RawLineRefused_IsReportedForTheServiceOfTheLine) {
    bench.unplug();
    bench.hear("asip/uno1/in", "S,W,0,90");
    bench.hear("asip/uno1/in", "I,d,13,1");
    bench.hear("asip/uno1/in", "T,P,440");
    EXPECT_EQ(error("servo")["request"], "W,0,90");
    EXPECT_EQ(error("servo")["reason"], "board-not-there");
    EXPECT_EQ(error("io")["request"], "d,13,1");
    EXPECT_EQ(error("T")["request"], "P,440") << "a service that the board does not have";
}

TEST_F(SilentSender, UnreadableRawText_IsReportedForIoAndCutShort) {
    bench.hear("asip/uno1/in", std::string(5000, '\xff'));
    EXPECT_EQ(error("io")["reason"], "invalid");
    EXPECT_LT(bench.on("asip/uno1/io/error")[0].size(), 1000u);
}

TEST_F(SilentSender, RetainedCommand_IsReportedAndClearingItIsNot) {
    bench.hear("asip/uno1/servo/in", "W,0,90", true);
    EXPECT_EQ(error("servo")["reason"], "retained");
    bench.hear("asip/uno1/servo/in", "");
    EXPECT_EQ(bench.on("asip/uno1/servo/error").size(), 1u);
}

TEST_F(SilentSender, TenThousandCommands_SomeRefusalsAreReportedAndTheOthersCounted) {
    bench.board.mute = true;
    for (int i = 0; i < 10'000; ++i)
        bench.hear("asip/uno1/servo/in", "W,0,90");
    const auto reported = bench.on("asip/uno1/servo/error").size();
    EXPECT_EQ(reported, Control::kRefusals);
    EXPECT_EQ(error("servo")["request"], "W,0,90");
    EXPECT_EQ(error("servo")["reason"], "queue-full");
    for (const auto& publication : bench.published)
        ASSERT_EQ(publication.priority, mqtt::Priority::kContext);
    bench.pass(100ms);
    bench.hear("asip/uno1/servo/in", "W,0,90");
    EXPECT_GT(error("servo", reported)["dropped"], 9'000);
}

TEST_F(SilentSender, TenThousandMessagesOfManyLinesOrOfAName_AreReportedAndNotedWithinABound) {
    bench.board.mute = true;
    std::string lines, nested(4000, '[');
    for (int i = 0; i < 64; ++i)
        lines += "I,d,13,1\n";
    for (int i = 0; i < 5'000; ++i) {
        bench.hear("asip/uno1/in", lines);
        bench.hear("asip/uno1/servo/in", R"({"write":)" + nested);
        bench.hear("asip/uno1/servo/in", json{{"write", {0, 900}}, {"by", "olga"}}.dump());
    }
    EXPECT_EQ(bench.on("asip/uno1/io/error").size() + bench.on("asip/uno1/servo/error").size(),
              Control::kRefusals);
    EXPECT_LE(bench.on("asip/servicebus/uno1/$commands").size(), Control::kRefusals);
}

TEST_F(SilentSender, FenceLost_TimeoutIsReported) {
    bench.board.swallow_fences = 1;
    bench.hear("asip/uno1/servo/in", "W,0,90");
    bench.pass(1s);
    bench.say("@I,a,1,{0:1}\r\n");
    bench.pass(1s);
    EXPECT_EQ(error("servo")["request"], "W,0,90");
    EXPECT_EQ(error("servo")["reason"], "timeout");
}

TEST_F(SilentSender, ErrorOfTheBoard_IsReportedOnce) {
    bench.board.replies["S,W,9,90"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    bench.hear("asip/uno1/servo/in", "W,9,90");
    bench.pass(1s);
    ASSERT_EQ(bench.on("asip/uno1/servo/error").size(), 1u);
    EXPECT_EQ(error("servo")["code"], 7);
}

TEST_F(SilentSender, ReplyWanted_NothingIsOnTheErrorTopic) {
    bench.ask("asip/uno1/servo/in", {{"write", {0, 900}}});
    EXPECT_THAT(bench.on("asip/uno1/servo/error"), IsEmpty());
}

TEST_F(SilentSender, CommandExecuted_NothingIsOnTheErrorTopic) {
    bench.hear("asip/uno1/servo/in", "W,0,90");
    bench.pass(1s);
    EXPECT_THAT(bench.board.executed, ElementsAre("S,W,0,90"));
    EXPECT_THAT(bench.on("asip/uno1/servo/error"), IsEmpty());
}

TEST_F(SilentSender, LineOfAPointToPointClientRefused_IsReported) {
    EXPECT_EQ(bench.client_says("#,B,500000"), Bridge::ClientResult::kRefused);
    EXPECT_EQ(error("io")["request"], "B,500000");
}

}  // namespace
}  // namespace asip::agent
