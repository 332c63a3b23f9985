// SPDX-License-Identifier: Apache-2.0
// The verbs stop, send --hold, top --stats and logs against a scripted agent; those with a real one are in
// tests/integration/agent/hold_test.cpp.
#include <gmock/gmock.h>

#include <csignal>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "tests/integration/cli/bus_fixture.hpp"

namespace asip::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

class StopTest : public BusTest {
  protected:
    /// Runs it, and answers its stop of each board in turn.
    Finished stop(Words words, const std::map<std::string, std::string>& answers) {
        words.insert(words.begin(), "stop");
        probe_.clear();
        ChildProcess child(program(words), environment());
        for (const auto& [board, reply] : answers) {
            const auto request = probe_.wait_for("asip/" + board + "/$stop");
            EXPECT_TRUE(request) << board;
            if (request) answer(*request, reply);
        }
        const auto status = child.wait_exit();
        return {status.value_or(-1), child.output(), child.errors()};
    }
    static constexpr const char* kStopped =
        R"({"status":"ok","proof":"fence","answer":{"executed":["M,S","I,d,13,0"],"refused":7}})";
};

TEST_F(StopTest, ManyBoards_AreAllStoppedBeforeAnyAnswers) {
    constexpr int kBoards = 200;
    std::vector<std::string> boards;
    for (int i = 0; i < kBoards; ++i)
        boards.push_back("crane" + std::to_string(i));
    for (const auto& board : boards)
        announce(board);
    probe_.clear();
    ChildProcess child(program({"stop", "crane*", "--from-bus", "--timeout", "60s"}), environment());
    std::vector<mqtt::Message> requests;
    for (const auto& board : boards)
        if (const auto request = probe_.wait_for("asip/" + board + "/$stop")) requests.push_back(*request);
    ASSERT_EQ(requests.size(), boards.size()) << child.errors();
    for (const auto& request : requests)
        answer(request, kStopped);
    EXPECT_EQ(child.wait_exit(), 0) << child.errors();
}

TEST_F(StopTest, BoardByItsName_IsStoppedWithoutBeingLookedFor) {
    const auto stopped = stop({"robot"}, {{"robot", kStopped}});
    EXPECT_EQ(stopped.status, 0) << stopped.errors;
    EXPECT_THAT(stopped.output, MatchesRegex("BOARD +RESULT +EXECUTED +REFUSED\n"
                                             "robot +stopped once +M,S I,d,13,0 +7\n"))
        << "of an agent that does not say that it holds";
}

TEST_F(StopTest, AskedToHold_SaysByWhomAndWhyAndShowsThatItDoes) {
    const auto stopped = stop({"robot", "--why", "dog"}, {{"robot", R"({"status":"ok","proof":"fence",
        "answer":{"executed":[],"refused":0,"latched":true}})"}});
    EXPECT_THAT(stopped.output, HasSubstr("stopped until resumed")) << stopped.errors;
    const auto request = json::parse(probe_.wait_for("asip/robot/$stop")->payload);
    EXPECT_EQ(request["latch"], true);
    EXPECT_EQ(request["why"], "dog");
    EXPECT_NE(request.value("by", ""), "");
    stop({"robot", "--once"}, {{"robot", kStopped}});
    EXPECT_FALSE(json::parse(probe_.wait_for("asip/robot/$stop")->payload).contains("latch"));
}

TEST_F(StopTest, Resume_AsksTheAgentAndSaysWhatItAnswered) {
    probe_.clear();
    ChildProcess child(program({"resume", "robot"}), environment());
    const auto request = probe_.wait_for("asip/robot/in");
    ASSERT_TRUE(request);
    EXPECT_EQ(json::parse(request->payload)["resume"], true);
    answer(*request, R"({"status":"ok","proof":"resumed"})");
    EXPECT_EQ(child.wait_exit(), 0);
    EXPECT_THAT(child.output(), HasSubstr("resumed"));
}

TEST_F(StopTest, All_StopsEveryBoardThatIsNotOffline) {
    announce("uno1");
    announce("uno2", "lost");
    announce("uno3", "offline");
    const auto stopped = stop({"--all", "--from-bus"}, {{"uno1", kStopped}, {"uno2", kStopped}});
    EXPECT_EQ(stopped.status, 0) << stopped.errors;
    EXPECT_THAT(stopped.output, HasSubstr("uno2"));
    EXPECT_EQ(probe_.count("asip/uno3/$stop"), 0u);
}

TEST_F(StopTest, PatternsAndNames_ChooseEachBoardOnce) {
    for (const char* board : {"crane1", "crane2", "robot"})
        announce(board);
    const auto stopped = stop({"crane*", "crane1", "crane1", "--from-bus", "--timeout", "2s", "-o", "jsonl"},
                              {{"crane1", kStopped}, {"crane2", kStopped}});
    EXPECT_EQ(stopped.status, 0) << stopped.errors;
    EXPECT_EQ(probe_.count("asip/crane1/$stop"), 1u);
    EXPECT_EQ(probe_.count("asip/robot/$stop"), 0u);
    EXPECT_EQ(json::parse(probe_.wait_for("asip/crane1/$stop")->payload).at("deadline_ms"), 1800)
        << "an agent that waits for its board answers before the patience ends";
    EXPECT_EQ(asipctl({"stop", "nothing*", "--from-bus"}).status, 4);
}

TEST_F(StopTest, NoConfirmation_IsStatus4AndTheOtherBoardIsStoppedAllTheSame) {
    const auto stopped = stop({"robot", "crane", "--timeout", "2s"}, {{"robot", kStopped}});
    EXPECT_EQ(stopped.status, 4);
    EXPECT_THAT(stopped.errors,
                HasSubstr("crane: no answer within 2000 ms; it may or may not have been executed"));
    EXPECT_THAT(stopped.output, HasSubstr("robot  stopped"));
    EXPECT_THAT(stopped.output, HasSubstr("not stopped"));
}

class HoldTest : public BusTest {
  protected:
    void SetUp() override { announce("uno1"); }
    std::optional<mqtt::Message> wait_payload(const std::string& part) {
        return probe_.wait_for([&](const mqtt::Message& message) {
            return message.topic == "asip/uno1/io/in" && message.payload.find(part) != std::string::npos;
        });
    }
};

TEST_F(HoldTest, TerminalThatIsClosed_UndoesTheCommandAtOnce) {
    ChildProcess child(program({"send", "uno1/io", "write", "13", "1", "--hold", "60s"}), environment());
    const auto command = wait_payload("hold_ms");
    ASSERT_TRUE(command) << child.errors();
    answer(*command, R"({"status":"ok","proof":"fence"})");
    ASSERT_TRUE(child.wait_for_output("ok"));
    child.signal(SIGHUP);
    EXPECT_TRUE(wait_payload("d,13,0"));
    EXPECT_EQ(child.wait_exit(), 4) << "nobody confirms it";
    EXPECT_THAT(child.errors(), HasSubstr("I,d,13,0 is not confirmed (no answer); were it lost, the agent "
                                          "would undo the command within 60000 ms"));
}

TEST_F(HoldTest, CtrlCBeforeTheAnswer_UndoesWhatMayBeExecuted) {
    ChildProcess child(program({"send", "uno1/io", "write", "13", "1", "--hold", "60s"}), environment());
    ASSERT_TRUE(wait_payload("hold_ms")) << child.errors();
    child.signal(SIGINT);
    const auto release = wait_payload("d,13,0");
    ASSERT_TRUE(release);
    answer(*release, R"({"status":"ok","proof":"fence"})");
    EXPECT_EQ(child.wait_exit(), 0) << child.errors();
}

TEST_F(HoldTest, ReleaseRefused_IsStatus1WithTheReason) {
    ChildProcess child(program({"send", "uno1/io", "write", "13", "1", "--hold", "60s"}), environment());
    const auto command = wait_payload("hold_ms");
    ASSERT_TRUE(command) << child.errors();
    answer(*command, R"({"status":"ok","proof":"fence"})");
    ASSERT_TRUE(child.wait_for_output("ok"));
    child.signal(SIGINT);
    const auto release = wait_payload("d,13,0");
    ASSERT_TRUE(release);
    answer(*release, R"({"status":"refused","reason":"queue-full","error":"too much waits"})");
    EXPECT_EQ(child.wait_exit(), 1);
    EXPECT_THAT(child.errors(), HasSubstr("I,d,13,0: refused (queue-full): too much waits"));
}

TEST_F(HoldTest, WhatCannotBeHeld_IsWrongUse) {
    for (const Words& words : {Words{"send", "uno1/servo", "write", "0", "90", "--hold", "1"},
                               Words{"send", "uno1/io", "write", "13", "1", "--hold", "10ms"},
                               Words{"send", "uno1/io", "write", "13", "1", "--for", "1s"},
                               Words{"send", "uno1", "--raw", "I,d,13,1", "--hold", "1"}})
        EXPECT_EQ(asipctl(words).status, 2) << words.back();
    EXPECT_EQ(probe_.count("asip/uno1/io/in"), 0u);
}

TEST_F(BusTest, Logs_ShowLinesOfBoardServiceAndAgent) {
    ChildProcess child(program({"events", "--logs", "uno1", "-o", "jsonl"}), environment());
    ASSERT_TRUE(wait_until([&] {
        probe_.publish("asip/uno1/out", "!hello");
        return !child.output().empty();
    })) << child.errors();
    probe_.publish("asip/uno2/out", "!another board");
    probe_.publish("asip/uno1/out", "@D,e,1,{42}");
    probe_.publish("asip/uno1/servo/error", R"({"request":"W","code":7,"error":"INVALID_DEVICE_NUMBER"})");
    probe_.publish("asip/servicebus/uno1/$log",
                   R"({"level":"warning","text":"board lost","why":"\u001b[2Jcable"})");
    probe_.publish("asip/servicebus/uno1/$log", R"({"level":"info","text":"board back"})");
    ASSERT_TRUE(child.wait_for_output("board back"));
    child.signal(SIGINT);
    EXPECT_EQ(child.wait_exit(), 0) << child.errors();
    std::set<std::string> seen;
    std::istringstream lines(child.output());
    for (std::string line; std::getline(lines, line);) {
        const auto record = json::parse(line);
        EXPECT_EQ(record["board"], "uno1");
        seen.insert(record["source"].get<std::string>() + " " + record["level"].get<std::string>() + " " +
                    record["text"].get<std::string>());
    }
    EXPECT_THAT(seen,
                ::testing::ElementsAre("agent info board back", "agent warning board lost  why=\x1b[2Jcable",
                                       "board info hello", "servo error W: INVALID_DEVICE_NUMBER (7)"));
}

}  // namespace
}  // namespace asip::test
