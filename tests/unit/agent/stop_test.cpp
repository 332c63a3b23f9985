// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/agent/bridge_bench.hpp"

namespace asip::agent {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr const char* kStop = "asip/uno1/$stop";

/// A board with motors.
struct StoppedBoard : testing::Test {
    StoppedBoard() {
        bench.board.services = "ISDM";
        bench.board.replies["#,N"] = "@#,N,4,{I:ASIP core IO,S:Servos,D:Distance,M:Motors}";
        bench.go_online();
        bench.published.clear();
        found = std::exchange(bench.board.executed, {});
    }
    json stop(const std::string& payload = R"({"id":"s","reply_to":"stops"})") {
        bench.hear(kStop, payload);
        const auto answers = bench.on("stops");
        return answers.empty() ? json() : json::parse(answers.back());
    }
    const std::vector<std::string>& executed() const { return bench.board.executed; }
    BridgeBench bench;
    std::vector<std::string> found;  ///< what was executed until it was online
};

TEST_F(StoppedBoard, FoundFirst_ItsMotorsAreStopped) {
    EXPECT_THAT(found, Contains("M,S")) << "an agent that died may have left them running";
}

TEST(StoppedBoardFound, OutputsToBeKept_NothingIsSent) {
    auto options = BridgeBench::defaults();
    options.keep_outputs = true;
    BridgeBench bench(options);
    bench.board.services = "IM";
    bench.board.replies["#,N"] = "@#,N,2,{I:ASIP core IO,M:Motors}";
    bench.go_online();
    EXPECT_THAT(bench.board.executed, Not(Contains("M,S")));
}

TEST_F(StoppedBoard, Stop_SendsWhatTheModelsSayAndAnswersWhatWasDone) {
    const auto answer = stop();
    EXPECT_THAT(executed(), ElementsAre("M,S"));
    EXPECT_EQ(answer, json::parse(R"({"id":"s","status":"ok","proof":"fence",
                                      "answer":{"executed":["M,S"],"refused":0}})"));
}

TEST_F(StoppedBoard, Stop_UndoesWhatWasSwitchedOnWhoeverDidIt) {
    bench.hear("asip/uno1/io/in", R"({"write":[13,1]})");
    bench.hear("asip/uno1/in", "I,a,3,128");
    bench.client_says("I,d,12,1");
    bench.pass(200ms);
    bench.board.executed.clear();
    EXPECT_EQ(stop()["status"], "ok");
    EXPECT_THAT(executed(), testing::UnorderedElementsAre("M,S", "I,d,13,0", "I,a,3,0", "I,d,12,0"));
}

TEST_F(StoppedBoard, PinThatIsOnWhileItIsLow_IsSetHigh) {
    bench.hear("asip/uno1/io/in", R"({"mode":[2,"output"]})");
    bench.hear("asip/uno1/io/in", R"({"write":[2,1]})");
    bench.hear("asip/uno1/io/in", R"({"mode":[3,"output"]})");
    bench.hear("asip/uno1/io/in", R"({"write":[3,0],"hold_ms":400})");
    bench.hear("asip/uno1/in",
               R"({"meanings":{"io/2":{"class":"light","inverted":true},"io/3":{"inverted":true}}})");
    bench.labels_kept();
    bench.pass(1s);
    bench.board.executed.clear();
    EXPECT_EQ(stop()["answer"]["executed"], json::parse(R"(["I,d,2,1","I,d,3,1","M,S"])"));
    EXPECT_THAT(executed(), testing::UnorderedElementsAre("M,S", "I,d,2,1", "I,d,3,1"));
    bench.hear("asip/uno1/io/in", R"({"write":[3,0],"hold_ms":400})");
    bench.board.executed.clear();
    bench.pass(1s);
    EXPECT_THAT(executed(), ElementsAre("I,d,3,1"));
}

TEST_F(StoppedBoard, RefusedByTheBoard_IsNotUndone) {
    bench.board.replies["I,d,99,1"] = "~I,d,3{INVALID_PIN}";
    bench.ask("asip/uno1/io/in", {{"write", {99, 1}}});
    bench.board.executed.clear();
    stop();
    EXPECT_THAT(executed(), ElementsAre("M,S"));
}

TEST_F(StoppedBoard, BoardRestarted_WhatWasOnBeforeIsForgotten) {
    bench.hear("asip/uno1/io/in", R"({"write":[13,1]})");
    bench.pass(200ms);
    bench.say(bench.board.reboot());
    bench.pass(3s);
    bench.board.executed.clear();
    stop();
    EXPECT_THAT(executed(), ElementsAre("M,S"));
}

TEST_F(StoppedBoard, BoardRestarted_WhatWasRestoredIsUndone) {
    bench.hear("asip/uno1/io/in", R"({"mode":[13,"output"]})");
    bench.hear("asip/uno1/io/in", R"({"write":[13,1]})");
    bench.pass(200ms);
    bench.say(bench.board.reboot());
    bench.pass(3s);
    bench.board.executed.clear();
    stop();
    EXPECT_THAT(executed(), testing::UnorderedElementsAre("M,S", "I,d,13,0"));
    bench.board.executed.clear();
    bench.say(bench.board.reboot());
    bench.pass(3s);
    EXPECT_THAT(executed(), testing::Not(testing::Contains("I,d,13,1"))) << "low is what stood";
}

TEST_F(StoppedBoard, WhatWaits_IsRefusedWithTheReason) {
    bench.board.mute = true;
    for (int i = 0; i < 40; ++i)
        bench.hear("asip/uno1/motors/in",
                   R"({"power":[0,255],"reply_to":"answers","id":")" + std::to_string(i) + "\"}");
    bench.hear(kStop, R"({"id":"s","reply_to":"stops"})");
    std::size_t refused = 0;
    for (const auto& text : bench.on("answers")) {
        const auto answer = json::parse(text);
        EXPECT_EQ(answer["status"], "refused");
        EXPECT_EQ(answer["reason"], "stopped");
        ++refused;
    }
    EXPECT_GE(refused, 30u);
    bench.board.mute = false;
    bench.pass(3s);
    ASSERT_FALSE(bench.on("stops").empty());
    const auto answer = json::parse(bench.on("stops").back());
    EXPECT_EQ(answer["status"], "ok");
    EXPECT_EQ(answer["answer"]["refused"], refused);
    EXPECT_THAT(executed(), Not(Contains(HasSubstr("M,m,0,255"))));
    EXPECT_EQ(bench.ask("asip/uno1/motors/in", {{"power", {0, 9}}}, "next")["status"], "ok")
        << "the next command works";
}

// Steps of work, not milliseconds.
TEST(StopBehindThousands, IsWrittenBeforeOneOfThemIsRefused) {
    BridgeBench bench;
    bench.board.extensions = false;  // one command at a time: what waits does not wait for room
    bench.board.services = "IM";
    bench.board.replies["#,N"] = "@#,N,2,{I:ASIP core IO,M:Motors}";
    bench.go_online();
    bench.pass(10s);
    bench.board.mute = true;
    constexpr std::size_t kSenders = 64;
    for (std::size_t i = 0; i < kSenders * 64; ++i)
        bench.hear("asip/uno1/motors/in", R"({"power":[0,255],"reply_to":"answers/)" +
                                              std::to_string(i % kSenders) + R"(","id":")" +
                                              std::to_string(i) + "\"}");
    ASSERT_GE(bench.bridge.session().queued(), 4000u);
    bench.published.clear();
    mqtt::Message stop{.topic = kStop, .payload = R"({"id":"s","reply_to":"stops"})"};
    Effects written;
    bench.bridge.take(*bench.bridge.read(stop, bench.now), bench.now, written);
    ASSERT_EQ(written.link.size(), 1u);
    EXPECT_THAT(std::get<session::Write>(written.link[0]).bytes, HasSubstr("M,S\n"));
    EXPECT_TRUE(written.publish.empty() && written.notes.empty()) << "nothing is answered first";
    ASSERT_TRUE(written.stopped);
    Effects refused;
    bench.bridge.refuse_waiting(bench.now, refused);
    EXPECT_GE(refused.publish.size(), 4000u);
    EXPECT_TRUE(refused.link.empty()) << "and none of them is sent";
    EXPECT_EQ(bench.bridge.session().queued(), 0u);
    bench.pass(6s);
    ASSERT_EQ(bench.on("stops").size(), 1u);
    EXPECT_GE(json::parse(bench.on("stops")[0])["answer"]["refused"], 4000u);
}

TEST_F(StoppedBoard, CommandNotHandledBeforeTheStop_IsRefused) {
    mqtt::Message message{.topic = "asip/uno1/motors/in",
                          .payload = R"({"power":[0,255],"reply_to":"answers","id":"late"})"};
    bench.hear(message, bench.now, true);
    ASSERT_EQ(bench.on("answers").size(), 1u);
    EXPECT_EQ(json::parse(bench.on("answers").front())["reason"], "stopped");
    EXPECT_THAT(executed(), testing::IsEmpty());
}

TEST_F(StoppedBoard, Holds_End) {
    bench.ask("asip/uno1/motors/in", {{"power", {0, 200}}, {"hold_ms", 500}}, "h");
    bench.board.executed.clear();
    stop();
    EXPECT_THAT(executed(), testing::UnorderedElementsAre("M,S", "M,s,0"));
    EXPECT_EQ(bench.ask("asip/uno1/motors/in", {{"renew", "h"}}, "r")["reason"], "not-held");
    bench.pass(10s);
    EXPECT_EQ(executed().size(), 2u);
}

TEST_F(StoppedBoard, PayloadOfAnyKind_Stops) {
    for (const std::string payload :
         {"", "now!", "{", "[]", R"({"id":[]})", R"({"stop":"everything"})", "\xff\xfe"}) {
        bench.board.executed.clear();
        bench.hear(kStop, payload);
        EXPECT_THAT(executed(), ElementsAre("M,S")) << payload;
    }
}

TEST_F(StoppedBoard, RetainedStop_IsRefused) {
    bench.hear(kStop, R"({"id":"s","reply_to":"stops"})", true);
    EXPECT_THAT(executed(), IsEmpty());
    EXPECT_EQ(json::parse(bench.on("stops").at(0))["reason"], "retained");
}

TEST_F(StoppedBoard, BoardNotThere_IsAnsweredInTimeAndStoppedWhenItIsBack) {
    bench.unplug();
    bench.hear(kStop, R"({"id":"s","reply_to":"stops","deadline_ms":200})");
    bench.pass(200ms);
    ASSERT_EQ(bench.on("stops").size(), 1u);
    EXPECT_EQ(json::parse(bench.on("stops")[0])["status"], "timeout");
    bench.pass(60s);
    bench.board.executed.clear();
    bench.plug();
    bench.pass(1s);
    EXPECT_EQ(executed().front(), "M,S");
    EXPECT_EQ(bench.on("stops").size(), 1u) << "one answer";
}

TEST_F(StoppedBoard, BoardRefuses_ItsWordsAreTheAnswer) {
    bench.board.replies["M,S"] = "~M,S,8{DEVICE_NOT_AVAILABLE}";
    const auto answer = stop();
    EXPECT_EQ(answer["status"], "error");
    EXPECT_EQ(answer["code"], 8);
    EXPECT_THAT(answer["error"].get<std::string>(), HasSubstr("M,S"));
}

TEST_F(StoppedBoard, ManyStopsAtOnce_AreEachAnsweredAndBounded) {
    bench.board.mute = true;
    for (int i = 0; i < 1000; ++i)
        bench.hear(kStop, R"({"reply_to":"stops","id":")" + std::to_string(i) + "\"}");
    bench.pass(6s);
    EXPECT_EQ(bench.on("stops").size(), 1000u);
}

TEST_F(StoppedBoard, ManyStopsOfOneUser_TakeNoPlaceOfAnother) {
    const auto stop_of = [&](const std::string& user, int id) {
        bench.hear(kStop,
                   R"({"reply_to":"asip/reply/)" + user + R"(/uno1/c","id":")" + std::to_string(id) + "\"}");
    };
    bench.board.mute = true;
    for (std::size_t i = 0; i < 2 * Safety::kMaxStops; ++i)
        stop_of("olga", static_cast<int>(i));
    EXPECT_EQ(bench.on("asip/reply/olga/uno1/c").size(), 2 * Safety::kMaxStops - Safety::kMaxStopsOfAsker);
    stop_of("ann", 1);
    EXPECT_THAT(bench.on("asip/reply/ann/uno1/c"), IsEmpty()) << "it waits for the board";
}

TEST_F(StoppedBoard, ManyStopsAtOnce_AreNotEachNoted) {
    for (int i = 0; i < 1000; ++i)
        bench.hear(kStop, "");
    EXPECT_THAT(bench.on("asip/servicebus/uno1/$commands").size(),
                testing::AllOf(testing::Ge(100), testing::Le(200)));
}

TEST(StopWithoutActuators, BoardAnswersAQuestion_IsOk) {
    OnlineBench bench;
    bench.hear(kStop, R"({"id":"s","reply_to":"stops"})");
    EXPECT_EQ(json::parse(bench.on("stops").at(0)), json::parse(R"({"id":"s","status":"ok","proof":"fence",
        "answer":{"executed":[],"refused":0}})"));
}

TEST(StopWithoutActuators, BoardThatIsGone_ConfirmsNothing) {
    OnlineBench bench;
    bench.unplug();
    bench.hear(kStop, R"({"id":"s","reply_to":"stops"})");
    EXPECT_THAT(bench.on("stops"), IsEmpty());
    bench.pass(5s);
    ASSERT_EQ(bench.on("stops").size(), 1u);
    const auto answer = json::parse(bench.on("stops")[0]);
    EXPECT_EQ(answer["status"], "timeout");
    EXPECT_EQ(answer["reason"], "board-not-there");
}

TEST(StopWithoutActuators, BoardThatIsSilent_ConfirmsNothing) {
    OnlineBench bench;
    bench.board.mute = true;
    bench.hear(kStop, R"({"id":"s","reply_to":"stops"})");
    bench.pass(6s);
    ASSERT_EQ(bench.on("stops").size(), 1u);
    EXPECT_EQ(json::parse(bench.on("stops")[0])["status"], "timeout");
}

TEST(StopBeforeTheNameIsOurs, IsNotExecuted) {
    BridgeBench bench;
    bench.plug();
    bench.connect();
    bench.hear(kStop, R"({"id":"s","reply_to":"stops"})");
    EXPECT_THAT(bench.on("stops"), IsEmpty());
}

}  // namespace
}  // namespace asip::agent
