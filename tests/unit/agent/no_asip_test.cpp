// SPDX-License-Identifier: Apache-2.0
// A board that speaks no ASIP: it is announced by the name of its port, and firmware is loaded into it.
#include <gmock/gmock.h>

#include "tests/unit/agent/bridge_bench.hpp"

namespace asip::agent {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

BridgeOptions nameless_of_a_service() {
    auto options = BridgeBench::defaults();
    options.name.clear();
    options.announce_unreached = true;
    return options;
}

/// A port where something is that does not answer.
struct NoAsipTest : testing::Test {
    NoAsipTest() : bench(nameless_of_a_service()) {
        bench.board.mute = true;
        bench.plug();
        bench.pass(9s);
        bench.connect();
        bench.pass(2s);
    }
    json description(const std::string& board = "ttyACM0") const {
        const auto all = bench.on("asip/servicebus/" + board + "/$description");
        return all.empty() || all.back().empty() ? json() : json::parse(all.back());
    }
    json ask(json request, const std::string& id) {
        request["by"] = "ann";
        return bench.ask("asip/ttyACM0/in", request, id);
    }
    json load(const std::string& id = "load") {
        return ask({{"port", "load"}, {"firmware", "AsipServices"}}, id);
    }
    json last_answer() const {
        const auto answers = bench.on("answers");
        return answers.empty() ? json() : json::parse(answers.back());
    }
    void progress(std::string_view step, int percent) {
        bench.run([&](Effects&) { bench.bridge.loading(step, percent); });
        bench.pass(1s);
    }
    void loaded(const Expected<void>& result) {
        bench.run([&](Effects& out) { bench.bridge.loaded(result, bench.now, out); });
    }

    BridgeBench bench;
};

TEST_F(NoAsipTest, Port_IsAnnouncedAsLostWithTheReason) {
    EXPECT_FALSE(bench.fatal);
    EXPECT_EQ(bench.bridge.name(), "ttyACM0");
    EXPECT_EQ(description()["state"]["is"], "lost") << description();
    EXPECT_EQ(description()["state"]["reason"], "silent");
    EXPECT_THAT(description()["warnings"][0].get<std::string>(), HasSubstr("does not answer"));
    EXPECT_TRUE(description()["services"].empty());
}

TEST_F(NoAsipTest, Port_IsFreeInBetweenAndAskedAgain) {
    for (int round = 0; round < 4; ++round) {
        EXPECT_EQ(bench.port, Effects::Port::kLetGo) << round;
        bench.pass(Bridge::kRest);
        EXPECT_EQ(bench.port, Effects::Port::kTakeBack) << round;
        bench.plug();
        bench.pass(10s);
    }
    EXPECT_EQ(description()["state"]["reason"], "silent");
    EXPECT_EQ(std::count_if(bench.notices.begin(), bench.notices.end(),
                            [](const auto& text) { return text.find("does not answer") != text.npos; }),
              1)
        << "the log says it once";
}

TEST_F(NoAsipTest, SketchComesByAnotherProgram_BoardIsOnline) {
    bench.pass(Bridge::kRest);
    bench.board.mute = false;
    bench.board.stored_name.clear();
    bench.plug();
    bench.pass(2s);
    EXPECT_EQ(description()["state"]["is"], "online");
    EXPECT_THAT(description().value("warnings", json::array()), IsEmpty());
}

TEST_F(NoAsipTest, BoardWithAStoredNameComes_PortIsForgotten) {
    bench.pass(Bridge::kRest);
    bench.board.mute = false;
    bench.board.stored_name = "left";
    bench.plug();
    bench.pass(2s);
    EXPECT_TRUE(bench.begin_anew);
    EXPECT_EQ(bench.on("asip/servicebus/ttyACM0/$state").back(), "") << "the last word of it";
    EXPECT_EQ(bench.on("asip/servicebus/ttyACM0/$description").back(), "");
}

TEST_F(NoAsipTest, AgentEnds_PortIsForgotten) {
    bench.run([&](Effects& out) { bench.bridge.goodbye(bench.now, out); });
    EXPECT_EQ(bench.on("asip/servicebus/ttyACM0/$state").back(), "");
}

TEST_F(NoAsipTest, Loaded_BoardIsOnlineAndTheAnswerSaysWhatItRuns) {
    EXPECT_TRUE(load().is_null()) << "not yet";
    ASSERT_TRUE(bench.to_load);
    EXPECT_EQ(bench.to_load->firmware, "AsipServices");
    EXPECT_EQ(bench.to_load->path, "/dev/ttyACM0");
    EXPECT_EQ(bench.port, Effects::Port::kLetGo);
    progress("writing", 40);
    EXPECT_EQ(description()["state"]["is"], "updating");
    EXPECT_EQ(description()["updating"],
              json({{"by", "ann"}, {"firmware", "AsipServices"}, {"step", "writing"}, {"percent", 40}}));
    loaded({});
    EXPECT_EQ(bench.port, Effects::Port::kTakeBack);
    bench.board.mute = false;
    bench.board.stored_name.clear();
    bench.plug();
    bench.pass(2s);
    EXPECT_EQ(last_answer()["status"], "ok") << last_answer();
    EXPECT_EQ(last_answer()["id"], "load");
    EXPECT_EQ(last_answer()["answer"]["after"]["sketch"], "Script");
    EXPECT_EQ(description()["state"]["is"], "online");
    EXPECT_FALSE(description().contains("updating"));
}

TEST_F(NoAsipTest, LoadedBoardHasAStoredName_TheAnswerTellsIt) {
    load();
    loaded({});
    bench.board.mute = false;
    bench.board.stored_name = "left";
    bench.plug();
    bench.pass(2s);
    EXPECT_TRUE(bench.begin_anew);
    EXPECT_EQ(last_answer()["answer"]["after"]["name"], "left") << last_answer();
    EXPECT_EQ(bench.on("asip/servicebus/ttyACM0/$state").back(), "");
}

TEST_F(NoAsipTest, NotLoaded_IsAnsweredAtOnceAndCanBeTriedAgain) {
    for (const auto* id : {"first", "second", "third"}) {
        load(id);
        loaded(fail("no boot loader answers"));
        EXPECT_EQ(last_answer()["id"], id);
        EXPECT_EQ(last_answer()["reason"], "not-loaded");
        EXPECT_EQ(last_answer()["error"], "no boot loader answers");
        EXPECT_EQ(bench.port, Effects::Port::kTakeBack);
    }
    bench.pass(1s);
    EXPECT_EQ(description()["state"]["is"], "lost");
    EXPECT_EQ(description()["state"]["reason"], "silent");
    bench.plug();
    bench.pass(10s);
    EXPECT_EQ(bench.port, Effects::Port::kLetGo) << "and it rests again";
}

TEST_F(NoAsipTest, LoadedAndSilent_IsAnsweredWithWhatToDo) {
    load();
    loaded({});
    bench.plug();
    bench.pass(21s);
    EXPECT_EQ(last_answer()["reason"], "not-loaded") << last_answer();
    EXPECT_THAT(last_answer()["error"].get<std::string>(), HasSubstr("reset button"));
    load("again");
    EXPECT_EQ(bench.port, Effects::Port::kLetGo);
}

TEST_F(NoAsipTest, WhileItIsLoaded_OthersAreRefused) {
    load();
    for (const auto& request : {json{{"port", "load"}, {"firmware", "AsipServices"}}, json{{"port", "take"}},
                                json{{"port", "release"}, {"seconds", 20}}}) {
        const auto refused = ask(request, "other " + request["port"].get<std::string>());
        EXPECT_EQ(refused["reason"], "released") << request;
        EXPECT_THAT(refused["error"].get<std::string>(), HasSubstr("firmware is being loaded for ann"));
    }
    EXPECT_EQ(bench.port, Effects::Port::kLetGo);
}

TEST_F(NoAsipTest, NameOfAFile_IsRefused) {
    for (const auto* firmware : {"../../etc/passwd", "/tmp/x", "", "a b"}) {
        bench.published.clear();
        EXPECT_EQ(ask({{"port", "load"}, {"firmware", firmware}}, std::string("bad ") + firmware)["reason"],
                  "invalid")
            << firmware;
    }
    EXPECT_FALSE(bench.to_load);
}

TEST(RunsAsip, IsNeverLoadedUnlessItIsAskedFor) {
    OnlineBench bench;
    const auto refused = bench.ask("asip/uno1/in", {{"port", "load"}, {"firmware", "AsipServices"}}, "1");
    EXPECT_EQ(refused["reason"], "speaks-asip") << refused;
    EXPECT_THAT(refused["error"].get<std::string>(), HasSubstr("--force"));
    EXPECT_FALSE(bench.to_load);
    bench.ask("asip/uno1/in",
              {{"port", "load"}, {"firmware", "AsipServices"}, {"force", true}, {"board", "mega"}}, "2");
    bench.pass(1s);
    ASSERT_TRUE(bench.to_load);
    EXPECT_EQ(bench.to_load->board, "mega");
}

struct OutOfDate : testing::Test {
    OutOfDate() : bench(options()) {
        bench.board.replies["#,X"] = "@#,X,3,{E:1,I:1,F:2}";
        bench.go_online();
    }
    BridgeOptions options() {
        auto options = BridgeBench::defaults();
        options.loadable_version = [this](const std::string& sketch, const std::string& chip) {
            return sketch == "Script" && chip == "ATmega328P" ? loadable : 0;
        };
        return options;
    }
    json firmware() const {
        return json::parse(bench.on("asip/servicebus/uno1/$description").back())["firmware"];
    }
    json update(const std::string& id) {
        bench.ask("asip/uno1/in", {{"port", "load"}, {"update", true}, {"by", "ann"}}, id);
        const auto answers = bench.on("answers");
        return answers.empty() ? json() : json::parse(answers.back());
    }
    /// The loader ended, and the board starts.
    json loaded(const char* extensions) {
        bench.run([&](Effects& out) { bench.bridge.loaded({}, bench.now, out); });
        bench.board.replies["#,X"] = extensions;
        bench.plug();
        bench.pass(1s);
        return json::parse(bench.on("answers").back());
    }
    int loadable = 103;
    BridgeBench bench;
};

TEST_F(OutOfDate, NewerVersion_IsTold_AndLoadedWhenItIsAskedFor) {
    EXPECT_EQ(firmware()["version"], "0.2");
    EXPECT_EQ(firmware()["available"], "1.3");
    bench.pass(1min);
    EXPECT_FALSE(bench.to_load) << "nothing is loaded by itself";
    update("1");
    bench.pass(1s);
    ASSERT_TRUE(bench.to_load);
    EXPECT_EQ(bench.to_load->firmware, "Script");
    const auto answer = loaded("@#,X,3,{E:1,I:1,F:103}");
    EXPECT_EQ(answer["status"], "ok") << answer;
    EXPECT_EQ(answer["answer"]["before"]["version"], "0.2");
    EXPECT_EQ(answer["answer"]["after"]["version"], "1.3");
    EXPECT_FALSE(firmware().contains("available")) << firmware();
}

TEST_F(OutOfDate, LoadedAndNotNewer_IsToldAsAFailure) {
    update("1");
    bench.pass(1s);
    const auto answer = loaded("@#,X,3,{E:1,I:1,F:2}");
    EXPECT_EQ(answer["reason"], "not-loaded") << answer;
    EXPECT_THAT(answer["error"].get<std::string>(),
                HasSubstr("the board says that it has Script 0.2, not 1.3"));
    EXPECT_EQ(firmware()["available"], "1.3");
}

TEST_F(OutOfDate, SecondRequest_FindsNothingToDo) {
    update("1");
    bench.pass(1s);
    EXPECT_EQ(update("2")["reason"], "released") << "while it is loaded for another user";
    loaded("@#,X,3,{E:1,I:1,F:103}");
    bench.to_load.reset();
    const auto answer = update("3");
    EXPECT_EQ(answer["status"], "ok") << answer;
    EXPECT_EQ(answer["answer"]["after"]["version"], "1.3");
    bench.pass(1s);
    EXPECT_FALSE(bench.to_load);
}

TEST_F(OutOfDate, BoardThatDoesNotAnswer_IsLeftAlone) {
    bench.board.mute = true;
    bench.pass(1min);
    const auto answer = update("1");
    EXPECT_EQ(answer["reason"], "not-loaded") << answer;
    bench.pass(1s);
    EXPECT_FALSE(bench.to_load);
}

TEST(NeverOutOfDate, WithoutExtensions_OrFromElsewhere) {
    auto options = BridgeBench::defaults();
    options.loadable_version = [](const std::string&, const std::string&) { return 103; };
    const auto firmware = [&](const char* extensions) {
        BridgeBench bench(options);
        bench.board.replies["#,X"] = extensions;
        bench.go_online();
        return json::parse(bench.on("asip/servicebus/uno1/$description").back())["firmware"];
    };
    EXPECT_EQ(firmware("@#,X,2,{E:1,I:1}")["available"], "1.3")
        << "older than the first that says its version";
    EXPECT_FALSE(firmware("~#,X,2{UNKNOWN}").contains("available")) << "a sketch of ASIP 0.4";
    EXPECT_FALSE(firmware("@#,X,3,{E:1,I:1,F:200}").contains("available")) << "newer than the agent's";
    EXPECT_FALSE(firmware("@#,X,3,{E:1,I:1,F:999}").contains("version")) << "no version";
}

TEST(StartedByHand, PortWhereNothingAnswers_EndsTheAgentAsBefore) {
    auto options = nameless_of_a_service();
    options.announce_unreached = false;
    BridgeBench bench(options);
    bench.board.mute = true;
    bench.plug();
    bench.pass(9s);
    EXPECT_TRUE(bench.fatal);
}

}  // namespace
}  // namespace asip::agent
