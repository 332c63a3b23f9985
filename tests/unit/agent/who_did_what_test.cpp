// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/agent/online_bridge.hpp"

namespace asip::agent {
namespace {

using nlohmann::json;
using testing::IsEmpty;

const std::string kNotes = "asip/servicebus/uno1/$commands";

json note(const std::string& text) {
    return json::parse(text);
}

TEST_F(OnlineBridge, CommandOfSomebodyWithAName_IsNotedBehindItsAnswer) {
    bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}, {"by", "anna"}});
    ASSERT_EQ(bench.on(kNotes).size(), 1u);
    EXPECT_EQ(
        json::parse(bench.on(kNotes)[0]),
        note(
            R"({"what":"command","by":"anna","service":"servo","request":"{\"write\":[0,90]}","status":"ok"})"));
    EXPECT_EQ(bench.published.back().message.topic, kNotes) << "nobody waits for it";
    EXPECT_FALSE(bench.published.back().message.retain);
}

TEST_F(OnlineBridge, SenderWithoutAName_IsNotedWhereItsCommandIsProven) {
    bench.hear("asip/uno1/in", "S,W,0,90");
    bench.pass(5s);
    EXPECT_THAT(bench.on(kNotes), IsEmpty()) << "nothing proves that it was executed";
    bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}});
    ASSERT_EQ(bench.on(kNotes).size(), 1u);
    EXPECT_EQ(
        json::parse(bench.on(kNotes)[0]),
        note(
            R"+({"what":"command","by":"(unnamed)","service":"servo","request":"{\"write\":[0,90]}","status":"ok"})+"));
}

TEST_F(OnlineBridge, NameInThePropertyOfTheMessage_IsTheOneThatCounts) {
    bench.hear(mqtt::Message{.topic = "asip/uno1/servo/in",
                             .payload = R"({"write":[0,90],"by":"eve"})",
                             .user_properties = {{"by", "anna"}}});
    bench.pass(5s);  // no client waits: it is over with the next sign of the board
    ASSERT_EQ(bench.on(kNotes).size(), 1u) << "also where nobody wants an answer";
    EXPECT_EQ(json::parse(bench.on(kNotes)[0])["by"], "anna");
    EXPECT_EQ(json::parse(bench.on(kNotes)[0])["status"], "sent") << "nothing proves that it was executed";
}

TEST_F(OnlineBridge, WhatWasRefusedOrFailed_IsNotedWithItsReason) {
    bench.board.replies["S,W,9,90"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    bench.ask("asip/uno1/servo/in", {{"write", {9, 90}}, {"by", "anna"}}, "1");
    bench.ask("asip/uno1/servo/in", {{"turn", 1}, {"by", "anna"}}, "2");
    bench.ask("asip/uno1/nothing/in", {{"turn", 1}, {"by", "anna"}}, "3");
    const auto notes = bench.on(kNotes);
    ASSERT_EQ(notes.size(), 3u);
    EXPECT_EQ(json::parse(notes[0])["status"], "error");
    EXPECT_EQ(json::parse(notes[0])["reason"], "INVALID_DEVICE_NUMBER");
    EXPECT_EQ(json::parse(notes[1])["reason"], "invalid");
    EXPECT_EQ(json::parse(notes[2])["service"], "nothing");
}

TEST_F(OnlineBridge, RepeatedCommand_IsNotedOnce) {
    for (int i = 0; i < 3; ++i)
        bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}, {"by", "anna"}}, "7");
    EXPECT_EQ(bench.on(kNotes).size(), 1u);
}

TEST_F(OnlineBridge, LongRequest_IsNotedByItsBeginning) {
    bench.hear("asip/uno1/in", json{{"raw", std::string(5000, 'S')}, {"by", "anna"}}.dump());
    ASSERT_EQ(bench.on(kNotes).size(), 1u);
    EXPECT_LT(bench.on(kNotes)[0].size(), 500u);
}

TEST_F(OnlineBridge, Stop_IsNotedWithWhoStopped) {
    bench.hear("asip/uno1/$stop", R"({"by":"anna"})");
    ASSERT_EQ(bench.on(kNotes).size(), 1u);
    EXPECT_EQ(json::parse(bench.on(kNotes)[0]), note(R"({"what":"stop","by":"anna","status":"ok"})"));
}

TEST_F(OnlineBridge, HoldThatIsNotRenewed_IsNotedAsUndone) {
    bench.hear("asip/uno1/io/in", R"({"write":[13,1],"hold_ms":500,"by":"anna","id":"7","reply_to":"a"})");
    bench.hear("asip/uno1/io/in", R"({"renew":"7","by":"anna","reply_to":"a"})");
    ASSERT_EQ(bench.on(kNotes).size(), 1u) << "a renewal is none";
    bench.pass(2s);
    ASSERT_EQ(bench.on(kNotes).size(), 2u);
    const auto undone = json::parse(bench.on(kNotes)[1]);
    EXPECT_EQ(undone["what"], "undone");
    EXPECT_EQ(undone["by"], "anna");
    EXPECT_EQ(undone["service"], "io");
    EXPECT_THAT(undone["reason"].get<std::string>(), testing::HasSubstr("not renewed within 500 ms"));
}

}  // namespace
}  // namespace asip::agent
