// SPDX-License-Identifier: Apache-2.0
// What the agent tells of its board's properties and values, and that no reader makes it send anything.
#include "agent/reports/board_values.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/unit/agent/online_bridge.hpp"

namespace asip::agent {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

struct ValuesOfBoard : OnlineBridge {
    json last(const std::string& topic) const {
        const auto all = bench.on(topic);
        return all.empty() ? json() : json::parse(all.back());
    }
    json values() const { return last("asip/uno1/$values")["values"]; }
    /// What the agent answers to a demander that asks for `services`.
    json asked(const std::string& services = "*", const std::string& reply_to = "asip/reply/ann/uno1/c1") {
        bench.hear("asip/servicebus/uno1/$demand/ann/c1",
                   json{{"services", {{services, 0}}}, {"reply_to", reply_to}, {"id", "7"}}.dump());
        return last(reply_to);
    }
};

TEST_F(ValuesOfBoard, Command_ShowsAtOnceToReadersThatAsk) {
    bench.ask("asip/uno1/io/in", {{"mode", {3, 3}}});
    bench.ask("asip/uno1/io/in", {{"write", {3, 1}}}, "2");
    EXPECT_EQ(asked()["answer"]["values"]["io/3"]["value"], true);
    bench.ask("asip/uno1/io/in", {{"write", {3, 0}}}, "3");
    auto answer = asked();
    EXPECT_EQ(answer["answer"]["values"]["io/3"]["value"], false);
    EXPECT_EQ(answer["answer"]["values"]["io/3"]["how"], "set");
    EXPECT_EQ(answer["id"], "7");
    EXPECT_EQ(answer["status"], "ok");
}

TEST_F(ValuesOfBoard, Asked_TheBoardIsSentNothing) {
    bench.ask("asip/uno1/io/in", {{"mode", {2, 2}}});
    bench.board.executed.clear();
    for (int i = 0; i < 100; ++i) {
        asked();
        bench.pass(100ms);
    }
    EXPECT_THAT(bench.board.executed, IsEmpty());
}

/// An agent that starts beside a board on which commands had made pin 2 an input and pin 3 an output.
std::unique_ptr<BridgeBench> beside_a_board_in_use(const std::string& extensions) {
    auto options = BridgeBench::defaults();
    options.load_labels = [](const std::string&) {
        model::Labels labels;
        labels.modes = {{2, 2}, {3, 3}};
        return Expected<model::Labels>(labels);
    };
    auto bench = std::make_unique<BridgeBench>(options);
    bench->board.replies = {
        {"I,p", "@I,p,6{0,0,2,3,7,7}"}, {"#,X", "@#,X," + extensions}, {"I,L", "@I,L,1,{4:0}"}};
    bench->go_online();
    bench->pass(10s);
    return bench;
}

TEST(LevelsOfABoard, NotTold_InputsAreSetOnceMore_OutputsNever) {
    const auto executed = beside_a_board_in_use("4,{E:1,I:1,B:1,C:1}")->board.executed;
    EXPECT_EQ(std::count(executed.begin(), executed.end(), "I,P,2,2"), 1);
    EXPECT_THAT(executed, Each(testing::Not(StartsWith("I,P,3"))));
    EXPECT_THAT(executed, Each(testing::Not(StartsWith("I,d"))));
}

TEST(LevelsOfABoard, Told_AreAskedAndNothingIsSet) {
    const auto bench = beside_a_board_in_use("5,{E:1,I:1,B:1,C:1,D:1}");
    EXPECT_THAT(bench->board.executed, Contains("I,L"));
    EXPECT_THAT(bench->board.executed, Each(testing::Not(StartsWith("I,P"))));
    const auto values = json::parse(bench->on("asip/uno1/$values").back())["values"];
    EXPECT_EQ(values["io/2"]["value"], true) << "low, with a pull-up";
    EXPECT_EQ(values["io/2"]["how"], "answered");
}

TEST_F(ValuesOfBoard, Command_IsToldWithinATenthOfASecond) {
    bench.ask("asip/uno1/io/in", {{"mode", {3, 3}}});
    for (int i = 0; i < 20; ++i) {
        const bool on = i % 2 == 0;
        bench.ask("asip/uno1/io/in", {{"write", {3, on ? 1 : 0}}}, std::to_string(i + 2));
        bench.pass(100ms);
        EXPECT_EQ(values()["io/3"]["value"], on) << i;
    }
}

TEST_F(ValuesOfBoard, DocumentOfAChange_ComesBehindTheAnswerThatToldIt) {
    bench.pass(1s);
    const auto before = bench.on("asip/uno1/$values").size();
    EXPECT_EQ(bench.ask("asip/uno1/servo/in", {{"write", {0, 77}}})["status"], "ok");
    EXPECT_THAT(bench.on("asip/uno1/$values"), SizeIs(before)) << "nothing is in the answer's way";
    bench.pass(BoardValues::kBehind);
    EXPECT_THAT(bench.on("asip/uno1/$values"), SizeIs(before + 1));
    EXPECT_EQ(values()["servo/0/angle"]["value"], 77);
}

TEST_F(ValuesOfBoard, AskedTooOften_AnswersTwentyASecond) {
    for (int i = 0; i < 100; ++i)
        asked();
    EXPECT_THAT(bench.on("asip/reply/ann/uno1/c1"), SizeIs(BoardValues::kMaxAnswers));
    bench.pass(1100ms);
    asked();
    EXPECT_THAT(bench.on("asip/reply/ann/uno1/c1"), SizeIs(BoardValues::kMaxAnswers + 1));
}

TEST_F(ValuesOfBoard, AskedToAnswerElsewhere_AnswersNothing) {
    for (const auto* topic : {"asip/reply/bob/uno1/c1", "asip/uno2/in", "asip/reply/ann/uno2/c1", "x"})
        EXPECT_EQ(asked("*", topic), json()) << topic;
}

TEST_F(ValuesOfBoard, ModeOfAPin_IsWhatThePinIsAndIsKept) {
    bench.ask("asip/uno1/io/in", {{"mode", {3, 3}}});
    bench.pass(1s);
    auto list = last("asip/servicebus/uno1/$properties");
    EXPECT_EQ(list["properties"].back()["id"], "io/3");
    EXPECT_EQ(last("asip/servicebus/uno1/$description")["pin_modes"]["3"], 3);
    bench.pass(20s);
    ASSERT_THAT(bench.to_keep, SizeIs(1));
    EXPECT_EQ(bench.to_keep[0].modes.at(3), 3);
    bench.labels_kept();
    bench.ask("asip/uno1/io/in", {{"mode", {3, 3}}}, "2");
    bench.pass(20s);
    EXPECT_THAT(bench.to_keep, SizeIs(1)) << "the same again is not written";
}

TEST_F(ValuesOfBoard, Meaning_IsKeptAndShownAnew) {
    bench.ask("asip/uno1/io/in", {{"mode", {2, 1}}});
    bench.say("@I,d,4,4\n");
    bench.pass(1s);
    EXPECT_EQ(values()["io/2"]["value"], true);
    bench.ask("asip/uno1/in", {{"meanings", {{"io/2", {{"class", "door"}, {"inverted", true}}}}}}, "2");
    ASSERT_THAT(bench.to_keep, SizeIs(1));
    EXPECT_EQ(bench.to_keep[0].meanings.at("io/2").klass, "door");
    bench.labels_kept();
    bench.pass(1s);
    EXPECT_EQ(values()["io/2"]["value"], false);
    EXPECT_EQ(last("answers")["answer"]["meanings"]["io/2"]["class"], "door");
}

TEST_F(ValuesOfBoard, CommandThatContradictsAMeaning_IsSaidWithTheCommandThatEndsIt) {
    bench.ask("asip/uno1/in", {{"meanings", {{"io/3", {{"class", "plug"}}}}}});
    bench.labels_kept();
    bench.ask("asip/uno1/io/in", {{"mode", {3, 2}}}, "2");
    bench.pass(1s);
    const auto list = last("asip/servicebus/uno1/$properties")["properties"];
    EXPECT_THAT(list.back()["refused"].get<std::string>(), testing::EndsWith(": asipctl pin uno1 3 output"));
}

TEST_F(ValuesOfBoard, ClassThatIsNone_IsRefusedWithTheNearest) {
    auto answer = bench.ask("asip/uno1/in", {{"meanings", {{"io/2", {{"class", "dor"}}}}}});
    EXPECT_EQ(answer["status"], "refused");
    EXPECT_THAT(answer["error"].get<std::string>(), testing::HasSubstr("did you mean \"door\""));
}

TEST_F(ValuesOfBoard, NumbersThatFlow_ArePacedAndTheLastIsTold) {
    bench.published.clear();
    for (int i = 0; i < 100; ++i) {
        bench.say("@D,e,1,{" + std::to_string(i) + "}\n");
        bench.pass(20ms);
    }
    bench.pass(2s);
    EXPECT_LE(bench.on("asip/uno1/$values").size(), 5U);
    EXPECT_EQ(values()["distance/0"]["value"], 99);
}

TEST_F(ValuesOfBoard, BoardAway_LastValuesStayAndAreUnknownAfterTheReturn) {
    bench.ask("asip/uno1/io/in", {{"mode", {3, 3}}});
    bench.ask("asip/uno1/io/in", {{"write", {3, 1}}}, "2");
    bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, "3");
    bench.pass(1s);
    bench.unplug();
    bench.pass(1s);
    EXPECT_EQ(values()["servo/0/angle"]["value"], 90);
    bench.plug();
    bench.pass(10s);
    EXPECT_EQ(values()["servo/0/angle"]["unknown"], "restart");
    EXPECT_EQ(values()["io/3"]["value"], true) << "the agent has set it again";
    EXPECT_EQ(values()["io/3"]["how"], "set");
}

TEST_F(ValuesOfBoard, BoardThatRestartsTwice_IsToldThoughNothingIsKnownAtEitherEnd) {
    const auto told = [this] { return last("asip/uno1/$values"); };
    bench.say(bench.board.reboot());
    bench.pass(10s);
    const auto before = told();
    bench.say("@D,e,1,{164}\n");
    bench.say(bench.board.reboot());
    bench.pass(10s);
    EXPECT_EQ(before["values"]["distance/0"]["unknown"], "restart");
    EXPECT_EQ(told()["values"]["distance/0"]["unknown"], "restart");
    EXPECT_GT(told()["restarts"], before["restarts"]);
    const auto seq = told()["seq"];
    bench.say(bench.board.reboot());
    bench.pass(10s);
    EXPECT_GT(told()["seq"], seq) << "readers are told, though no value is another one";
}

TEST_F(ValuesOfBoard, WhoeverSentIt_IsKnown) {
    for (const auto* pin : {"2", "3"})
        bench.hear("asip/uno1/in", std::string("I,P,") + pin + ",3");
    bench.hear("asip/uno1/io/in", R"({"write":[3,1]})");
    bench.hear("asip/uno1/in", "S,W,0,90");
    bench.client_says("I,d,2,1");
    bench.pass(1s);
    for (const auto* id : {"io/2", "io/3"})
        EXPECT_EQ(values()[id]["value"], true) << id;
    EXPECT_EQ(values()["servo/0/angle"]["value"], 90);
}

TEST_F(ValuesOfBoard, RefusedByAgentOrBoard_IsUnchanged) {
    bench.board.replies["S,W,0,91"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}});
    EXPECT_EQ(bench.ask("asip/uno1/servo/in", {{"write", {0, 91}}}, "2")["status"], "error");
    EXPECT_EQ(bench.ask("asip/uno1/servo/in", {{"write", {0, 999}}}, "3")["status"], "refused");
    bench.pass(1s);
    EXPECT_EQ(values()["servo/0/angle"]["value"], 90);
}

TEST_F(ValuesOfBoard, HoldNotRenewed_IsUndoneThere) {
    bench.ask("asip/uno1/io/in", {{"mode", {3, 3}}});
    bench.ask("asip/uno1/io/in", {{"write", {3, 1}}, {"hold_ms", 1000}}, "2");
    bench.pass(100ms);
    EXPECT_EQ(values()["io/3"]["value"], true);
    bench.pass(3s);
    EXPECT_EQ(values()["io/3"]["value"], false);
}

TEST_F(ValuesOfBoard, Stopped_IsUndoneThere) {
    bench.ask("asip/uno1/io/in", {{"mode", {3, 3}}});
    bench.ask("asip/uno1/io/in", {{"write", {3, 1}}}, "2");
    bench.hear("asip/uno1/$stop", "");
    bench.pass(1s);
    EXPECT_EQ(values()["io/3"]["value"], false);
}

TEST_F(ValuesOfBoard, NoProof_IsNotKnownAnyMore) {
    bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}});
    bench.board.mute = true;
    bench.hear("asip/uno1/servo/in", R"({"write":[0,10],"deadline_ms":1000,"id":"3","reply_to":"answers"})");
    bench.pass(1200ms);
    EXPECT_EQ(values()["servo/0/angle"]["unknown"], "doubt") << "it may be at either";
}

TEST_F(ValuesOfBoard, BrokerKeepsWhatAnOlderAgentSaid_IsClearedAndNothingElseIsSaidThere) {
    bench.hear("asip/uno1/io/set", R"({"write":{"13":1}})", true);
    bench.hear("asip/uno1/flashed-away/set", R"({"power":{"0":1}})", true);
    bench.hear("asip/uno2/io/set", R"({"write":{"13":1}})", true);
    bench.hear("asip/uno1/servo/set", R"({"write":{"0":1}})");
    bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}});
    bench.pass(1s);
    EXPECT_THAT(bench.on("asip/uno1/io/set"), ElementsAre(""));
    EXPECT_THAT(bench.on("asip/uno1/flashed-away/set"), ElementsAre(""));
    EXPECT_THAT(bench.on("asip/uno2/io/set"), IsEmpty());
    EXPECT_THAT(bench.on("asip/uno1/servo/set"), IsEmpty());
    for (const auto& publication : bench.published)
        EXPECT_TRUE(publication.message.retain || publication.message.topic != "asip/uno1/io/set");
}

TEST_F(ValuesOfBoard, BrokerStartedAnew_IsToldBothAgain) {
    bench.published.clear();
    bench.connect();
    bench.pass(1s);
    EXPECT_THAT(bench.on("asip/servicebus/uno1/$properties"), SizeIs(1));
    EXPECT_THAT(bench.on("asip/uno1/$values"), SizeIs(1));
}

// Readers that have the documents of a session take others behind the description of theirs.
TEST(RetainedOfABoard, PropertiesAndValues_ComeBehindTheDescription) {
    OnlineBench bench;
    std::vector<std::string> kinds;
    for (const auto& [message, priority] : bench.published)
        for (const auto* kind : {"$description", "$properties", "$values"})
            if (message.topic.ends_with(kind)) kinds.emplace_back(kind);
    ASSERT_THAT(kinds, testing::IsSupersetOf({"$description", "$properties", "$values"}));
    EXPECT_EQ(kinds.front(), "$description");
}

TEST_F(ValuesOfBoard, Documents_CarrySessionAndRisingNumbers) {
    std::uint64_t before = 0;
    for (int i = 0; i < 3; ++i) {
        bench.ask("asip/uno1/servo/in", {{"write", {0, 10 * i}}}, std::to_string(i));
        bench.pass(1s);
        auto document = last("asip/uno1/$values");
        EXPECT_EQ(document["session"], "00000003e8111111");
        EXPECT_GT(document["seq"].get<std::uint64_t>(), before);
        before = document["seq"];
    }
}

/// Before there were properties, the broker kept the description and the state.
TEST(RetainedOfABoard, Properties_AtMostDoubleTheBytes) {
    BridgeBench bench;
    bench.board.replies = {
        {"#,S", "@#,S,20,{@,@,I,I,I,I,I,D,D,S,S,I,I,I,I,I,I,I,I,I}"},
        {"I,M",
         "@I,M,20,{4:1,4:2,4:4,4:8,4:10,4:20,4:40,4:80,2:1,2:2,2:4,2:8,2:10,2:20,3:1,3:2,3:4,"
         "3:8,3:10,3:20}"},
        {"I,m", "@I,m,6,{14:0,15:1,16:2,17:3,18:4,19:5}"},
        {"I,p", "@I,p,20{6,6,1,1,1,1,1,7,7,7,7,1,1,1,1,1,1,1,1,1}"},
        {"I,c", "@I,c,20,{1,1,1,5,1,5,5,1,1,5,5,5,1,1,3,3,3,3,3,3}"}};
    bench.go_online();
    bench.say("@D,e,2,{42,17}\r\n");
    bench.pass(2s);
    std::map<std::string, std::size_t> bytes;
    for (const auto& each : bench.published)
        if (each.message.retain) bytes[each.message.topic] = each.message.payload.size();
    const auto list = json::parse(bench.on("asip/servicebus/uno1/$properties").back())["properties"];
    EXPECT_EQ(list.size(), 4U) << "two servos, two distances";
    EXPECT_THAT(bytes, SizeIs(4));
    EXPECT_LE(bytes["asip/servicebus/uno1/$properties"] + bytes["asip/uno1/$values"],
              bytes["asip/servicebus/uno1/$description"] + bytes["asip/servicebus/uno1/$state"]);
}

TEST_F(ValuesOfBoard, ButtonThatBounces_IsOnePressAndOneHold) {
    bench.ask("asip/uno1/in", {{"meanings", {{"io/2", {{"class", "button"}}}}}});
    bench.labels_kept();
    bench.board.replies["I,P,2,2"] = "@I,d,4,4";  // boards say the level of a new input that is high
    bench.ask("asip/uno1/io/in", {{"mode", {2, 2}}}, "2");
    bench.pass(1s);
    EXPECT_EQ(values()["io/2"]["value"], false);
    bench.published.clear();
    for (const auto* level : {"0", "4", "0", "4", "0"}) {
        bench.say(std::string("@I,d,4,") + level + "\n");
        bench.pass(2ms);
    }
    EXPECT_THAT(bench.on("asip/uno1/$values"), SizeIs(1)) << "at once";
    EXPECT_EQ(values()["io/2"]["value"], true);
    EXPECT_EQ(values()["io/2"]["events"], json::parse(R"([[1,"press"]])"));
    bench.pass(1s);
    EXPECT_THAT(bench.on("asip/uno1/$values"), SizeIs(2)) << "a bounce makes no second value";
    EXPECT_EQ(values()["io/2"]["events"], json::parse(R"([[1,"press"],[2,"hold"]])"));
}

}  // namespace
}  // namespace asip::agent
