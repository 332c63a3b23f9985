// SPDX-License-Identifier: Apache-2.0
// A stop that holds until a user resumes the board.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "agent/safety/stop_files.hpp"
#include "tests/support/temp_dir.hpp"
#include "tests/unit/agent/bridge_bench.hpp"

namespace asip::agent {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr const char* kStopTopic = "asip/uno1/$stop";

struct Latched : testing::Test {
    explicit Latched(BridgeOptions options = BridgeBench::defaults()) : bench(std::move(options)) {
        bench.board.services = "ISDM";
        bench.board.replies["#,N"] = "@#,N,4,{I:ASIP core IO,S:Servos,D:Distance,M:Motors}";
        bench.go_online();
        bench.published.clear();
        found = std::exchange(bench.board.executed, {});
    }
    json stop() {
        return bench.ask(kStopTopic, {{"latch", true}, {"why", "dog on the track"}, {"by", "ann"}}, "s");
    }
    json power(const std::string& id) { return bench.ask("asip/uno1/motors/in", {{"power", {0, 100}}}, id); }
    json resume(const std::string& id = "r") {
        return bench.ask("asip/uno1/in", {{"resume", true}, {"by", "bob"}}, id);
    }
    json said() const { return json::parse(bench.on("asip/servicebus/uno1/$description").back()); }
    BridgeBench bench;
    std::vector<std::string> found;
};

TEST_F(Latched, Stopped_RefusesCommandsAndSaysByWhomAndWhy) {
    const auto answer = stop();
    EXPECT_EQ(answer["status"], "ok");
    EXPECT_EQ(answer["answer"]["latched"], true);
    bench.board.executed.clear();
    const auto refused = power("2");
    EXPECT_EQ(refused["status"], "refused");
    EXPECT_EQ(refused["reason"], "stopped");
    EXPECT_THAT(
        refused["error"].get<std::string>(),
        testing::AllOf(HasSubstr("by ann"), HasSubstr("dog on the track"), HasSubstr("asipctl resume uno1")));
    EXPECT_EQ(bench.ask("asip/uno1/in", {{"raw", "M,m,0,100"}}, "3")["reason"], "stopped");
    EXPECT_EQ(bench.client_says("M,m,0,100"), Bridge::ClientResult::kRefused);
    bench.pass(1s);
    EXPECT_THAT(bench.board.executed, Not(Contains("M,m,0,100")));
}

TEST_F(Latched, Stopped_QuestionsReportsAndStopsPass) {
    stop();
    EXPECT_EQ(bench.ask("asip/uno1/in", {{"raw", "#,?"}}, "2")["status"], "ok");
    EXPECT_EQ(bench.ask("asip/uno1/distance/in", {{"report", 100}}, "3")["status"], "ok");
    EXPECT_EQ(bench.ask("asip/uno1/io/in", {{"modes", nullptr}}, "4")["status"], "ok");
    EXPECT_EQ(stop()["status"], "ok");
}

TEST_F(Latched, Stopped_EachViewShowsIt) {
    stop();
    bench.pass(1s);
    EXPECT_EQ(said()["state"]["is"], "online");
    EXPECT_EQ(said()["state"]["reason"], "latched");
    EXPECT_EQ(said()["stopped"]["by"], "ann");
    EXPECT_EQ(said()["stopped"]["why"], "dog on the track");
    resume();
    bench.pass(1s);
    EXPECT_FALSE(said()["state"].contains("reason"));
    EXPECT_FALSE(said().contains("stopped"));
}

TEST_F(Latched, Resumed_TakesCommandsAgain) {
    stop();
    EXPECT_EQ(resume()["proof"], "resumed");
    EXPECT_EQ(power("2")["status"], "ok");
    EXPECT_EQ(resume("again")["status"], "ok") << "of a board that is not stopped";
}

TEST_F(Latched, WithoutLatch_IsOnce) {
    EXPECT_EQ(bench.ask(kStopTopic, json::object(), "s")["status"], "ok");
    EXPECT_EQ(power("2")["status"], "ok");
    bench.hear(kStopTopic, "anything");
    EXPECT_EQ(power("3")["status"], "ok");
}

TEST_F(Latched, RetainedResumeOrStop_ChangesNothing) {
    bench.hear(kStopTopic, R"({"latch":true})", true);
    EXPECT_EQ(power("2")["status"], "ok");
    stop();
    bench.hear("asip/uno1/in", R"({"resume":true})", true);
    EXPECT_EQ(power("3")["reason"], "stopped");
}

TEST_F(Latched, ResumeThatCameLate_ChangesNothing) {
    stop();
    mqtt::Message message{.topic = "asip/uno1/in",
                          .payload = R"({"resume":true,"deadline_ms":1000,"id":"r","reply_to":"answers"})"};
    const auto read_at = bench.now;
    bench.pass(2s);
    bench.hear(message, read_at);
    EXPECT_EQ(json::parse(bench.on("answers").back())["reason"], "deadline");
    EXPECT_EQ(power("3")["reason"], "stopped");
}

// Stops come over a connection of their own: one may be slower than the resume that its sender sent behind
// it.
TEST_F(Latched, StopAndResume_InBothOrders_TheLaterWordHolds) {
    const auto clock = [&] {
        return bench.ask("asip/uno1/in", {{"raw", "#,?"}, {"clock", ""}}, "c")["clock"];
    };
    const auto first = clock();
    ASSERT_TRUE(first.is_string());
    bench.pass(100ms);
    const auto second = clock();
    const auto stop_at = [&](const json& sent) {
        return bench.ask(kStopTopic, {{"latch", true}, {"by", "ann"}, {"clock", sent}}, "s");
    };
    const auto resume_at = [&](const json& sent) {
        return bench.ask("asip/uno1/in", {{"resume", true}, {"by", "ann"}, {"clock", sent}}, "r");
    };
    EXPECT_EQ(stop_at(first)["status"], "ok");
    EXPECT_EQ(resume_at(second)["status"], "ok");
    EXPECT_EQ(power("1")["status"], "ok");
    const auto late = stop_at(first);
    EXPECT_EQ(late["reason"], "deadline");
    EXPECT_THAT(late["error"].get<std::string>(), HasSubstr("resumed after this stop was sent"));
    EXPECT_EQ(power("2")["status"], "ok");
    bench.pass(100ms);
    EXPECT_EQ(stop_at(clock())["status"], "ok");
    EXPECT_EQ(power("3")["reason"], "stopped");
}

// An operator may resume a board, and must not make it deaf for the stops of others, nor for its own later
// ones.
TEST_F(Latched, ResumeThatTellsATimeInTheFuture_OrOfAnother_DefeatsNoStop) {
    const auto clock = [&] {
        return bench.ask("asip/uno1/in", {{"raw", "#,?"}, {"clock", ""}}, "c")["clock"].get<std::string>();
    };
    const auto sent = clock();
    const auto future = sent.substr(0, 9) + "3999999999999";
    const auto resume_of = [&](const std::string& by, const std::string& at) {
        return bench.ask("asip/uno1/in", {{"resume", true}, {"by", by}, {"clock", at}}, "r")["status"];
    };
    const auto stop_of_ann = [&](const std::string& at) {
        return bench.ask(kStopTopic, {{"latch", true}, {"by", "ann"}, {"clock", at}}, "s")["status"];
    };
    EXPECT_EQ(resume_of("ann", future), "ok");
    bench.pass(100ms);
    EXPECT_EQ(stop_of_ann(clock()), "ok");
    bench.pass(100ms);
    EXPECT_EQ(resume_of("mallory", clock()), "ok");
    EXPECT_EQ(stop_of_ann(sent), "ok");
    bench.pass(100ms);
    // By another program, though in her name.
    bench.hear("asip/uno1/in",
               json{{"resume", true}, {"by", "ann"}, {"clock", clock()}, {"reply_to", "others"}}.dump());
    EXPECT_EQ(stop_of_ann(sent), "ok");
}

TEST_F(Latched, BoardRestartsOrIsReplugged_StaysStopped) {
    stop();
    bench.say(bench.board.reboot());
    bench.pass(5s);
    EXPECT_EQ(power("2")["reason"], "stopped");
    bench.unplug();
    bench.pass(1s);
    EXPECT_EQ(said()["state"]["is"], "lost");
    bench.plug();
    bench.pass(5s);
    EXPECT_EQ(said()["state"]["reason"], "latched");
    EXPECT_EQ(power("3")["reason"], "stopped");
}

TEST_F(Latched, BoardRestarts_NoPinBeginsToDriveUntilItIsResumed) {
    auto io = [&, number = 0](json command) mutable {
        return bench.ask("asip/uno1/io/in", std::move(command), "io" + std::to_string(++number));
    };
    io({{"mode", {13, "output"}}});
    io({{"write", {13, 1}}});
    io({{"mode", {2, "input-pullup"}}});
    stop();
    bench.board.executed.clear();
    bench.say(bench.board.reboot());
    bench.pass(5s);
    EXPECT_THAT(bench.board.executed, Contains("I,P,2,2"));
    EXPECT_THAT(bench.board.executed, Not(Contains(testing::EndsWith(",13,3"))));
    EXPECT_THAT(bench.board.executed, Not(Contains(testing::StartsWith("I,d,13,"))));
    resume();
    bench.pass(1s);
    EXPECT_THAT(bench.board.executed, Contains("I,P,13,3"));
    EXPECT_THAT(bench.board.executed, Contains("I,d,13,0"));
    EXPECT_THAT(bench.board.executed, Not(Contains("I,d,13,1"))) << "the stop ended it";
}

BridgeOptions kept_options(Expected<std::optional<model::StopInfo>> kept) {
    auto options = BridgeBench::defaults();
    options.keep_outputs = true;
    options.load_stop = [kept](const std::string&) { return kept; };
    return options;
}

struct LatchKept : Latched {
    LatchKept()
        : Latched(kept_options(std::optional(model::StopInfo{"ann", "dog", "2026-11-26T10:00:00Z"}))) {}
};
TEST_F(LatchKept, AgentStartsAgain_ItHoldsAndTheBoardIsStoppedFirst) {
    EXPECT_THAT(found, Contains("M,S")) << "whatever it did meanwhile";
    EXPECT_THAT(power("2")["error"].get<std::string>(), HasSubstr("by ann"));
    EXPECT_EQ(resume()["status"], "ok");
    EXPECT_EQ(power("3")["status"], "ok");
}

struct LatchDamaged : Latched {
    LatchDamaged() : Latched(kept_options(fail("stopped/uno1.json: not JSON"))) {}
};
TEST_F(LatchDamaged, KeptOneCannotBeRead_CountsAsAStop) {
    EXPECT_THAT(power("2")["error"].get<std::string>(), HasSubstr("stopped/uno1.json"));
    resume();
    EXPECT_EQ(power("3")["status"], "ok");
}

TEST(StopFiles, KeptAndRemoved_IsReadAsItWas) {
    const test::TempDir folder;
    const StopFiles files(folder.path());
    const model::StopInfo stopped{"ann", "dog on the track", "2026-11-26T10:00:00.000Z"};
    EXPECT_FALSE(files.load("uno1")->has_value());
    ASSERT_TRUE(files.save("uno1", stopped));
    EXPECT_EQ(**files.load("uno1"), stopped);
    EXPECT_FALSE(files.load("uno2")->has_value());
    ASSERT_TRUE(files.save("uno1", std::nullopt));
    EXPECT_FALSE(files.load("uno1")->has_value());
    ASSERT_TRUE(files.save("uno1", std::nullopt)) << "twice";
}

TEST(StopFiles, DamagedOrNoFolder_SaysSo) {
    const test::TempDir folder;
    folder.write("stopped.txt", "");
    std::filesystem::create_directories(std::filesystem::path(folder.path()) / "stopped");
    folder.write("stopped/uno1.json", "{");
    const auto loaded = StopFiles(folder.path()).load("uno1");
    ASSERT_FALSE(loaded);
    EXPECT_THAT(loaded.error(), HasSubstr("uno1.json"));
    EXPECT_FALSE(StopFiles("").save("uno1", model::StopInfo{}));
    EXPECT_FALSE(StopFiles("").load("uno1")->has_value());
}

}  // namespace
}  // namespace asip::agent
