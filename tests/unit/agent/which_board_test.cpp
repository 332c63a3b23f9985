// SPDX-License-Identifier: Apache-2.0
// Which board is at the port, and how often it restarts.
#include <gmock/gmock.h>

#include "tests/unit/agent/bridge_bench.hpp"

namespace asip::agent {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

BridgeOptions without_name() {
    auto options = BridgeBench::defaults();
    options.name.clear();
    return options;
}

std::vector<std::string> warnings_of(BridgeBench& bench, const std::string& board) {
    const auto descriptions = bench.on("asip/servicebus/" + board + "/$description");
    return descriptions.empty() ? std::vector<std::string>()
                                : model::parse_description(descriptions.back()).value().warnings;
}

void swap_board(BridgeBench& bench, const std::function<void(session::ScriptedBoard&)>& change) {
    bench.unplug();
    bench.pass(3s);
    change(bench.board);
    bench.board.executed.clear();
    bench.published.clear();
    bench.plug();
    bench.pass(3s);
}

TEST(WhichBoard, BoardOfAnotherStoredNameComes_AgentBeginsAnewAndNothingReachesIt) {
    BridgeBench bench(without_name());
    bench.board.stored_name = "left";
    bench.go_online();
    ASSERT_EQ(bench.bridge.name(), "left");
    bench.hear("asip/left/in", "I,P,5,3");
    bench.pass(1s);
    swap_board(bench, [](auto& board) { board.stored_name = "right"; });
    EXPECT_TRUE(bench.begin_anew);
    bench.hear("asip/left/servo/in", R"({"write":[0,90],"id":"1","reply_to":"answers"})");
    bench.hear("asip/left/$stop", R"({"id":"2","reply_to":"answers"})");
    EXPECT_EQ(bench.client_says("S,W,0,90"), Bridge::ClientResult::kRefused);
    bench.pass(5s);
    EXPECT_THAT(bench.board.executed, IsEmpty()) << "neither commands nor the other board's settings";
    EXPECT_THAT(bench.on("asip/servicebus/left/$state"), Not(Contains("online")));
}

TEST(WhichBoard, NamelessBoardComesWhereANamedOneWas_AgentBeginsAnew) {
    BridgeBench bench(without_name());
    bench.board.stored_name = "left";
    bench.go_online();
    swap_board(bench, [](auto& board) { board.stored_name.clear(); });
    EXPECT_TRUE(bench.begin_anew);
}

TEST(WhichBoard, NamedBoardComesWhereANamelessOneWas_AgentBeginsAnew) {
    BridgeBench bench(without_name());
    bench.board.stored_name.clear();
    bench.go_online();
    ASSERT_EQ(bench.bridge.name(), "ttyACM0");
    swap_board(bench, [](auto& board) { board.stored_name = "right"; });
    EXPECT_TRUE(bench.begin_anew);
}

TEST(WhichBoard, SameBoardComesBack_NothingBeginsAnewAndItsSettingsAreRestored) {
    BridgeBench bench(without_name());
    bench.board.stored_name = "left";
    bench.go_online();
    bench.hear("asip/left/in", "I,P,5,3");
    bench.pass(1s);
    swap_board(bench, [](auto&) {});
    EXPECT_FALSE(bench.begin_anew);
    EXPECT_THAT(bench.board.executed, Contains("I,P,5,3"));
}

TEST(WhichBoard, BoardIsElsewhereAndItsNameIsClaimed_AgentLetsGoOfTheName) {
    BridgeBench bench(without_name());
    bench.board.stored_name = "left";
    bench.go_online();
    bench.unplug();
    bench.published.clear();
    bench.hear("asip/servicebus/$probe", "left");
    bench.pass(1s);
    EXPECT_THAT(bench.on("asip/servicebus/left/$description"), IsEmpty()) << "the claim succeeds";
    const auto other = [](int seq) {
        return R"({"board":"left","session":"9999999999","seq":)" + std::to_string(seq) +
               R"(,"services":[]})";
    };
    bench.hear("asip/servicebus/left/$description", other(1));
    bench.hear("asip/servicebus/left/$description", other(2));
    EXPECT_FALSE(bench.fatal);
    EXPECT_TRUE(bench.begin_anew);
}

TEST(WhichBoard, GivenNameAndAnotherSketch_IsAWarningUntilTheFirstBoardIsBack) {
    OnlineBench bench;
    EXPECT_THAT(warnings_of(bench, "uno1"), IsEmpty());
    for (const auto& change : std::vector<std::function<void(session::ScriptedBoard&)>>{
             [](auto& board) { board.sketch = "Other"; }, [](auto& board) { board.chip = "ATmega2560"; },
             [](auto& board) { board.stored_name = "right"; }}) {
        bench.pass(130s);  // plugged and unplugged too often is a warning of its own
        const auto first = bench.board;
        swap_board(bench, change);
        EXPECT_FALSE(bench.begin_anew);
        EXPECT_THAT(warnings_of(bench, "uno1"), Contains(HasSubstr("another board than at first")));
        swap_board(bench, [&](auto& board) { board = first; });
        EXPECT_THAT(warnings_of(bench, "uno1"), IsEmpty());
    }
}

TEST(WhichBoard, RestartsAgainAndAgain_IsAWarningAndOneLineAMinute) {
    OnlineBench bench;
    bench.logged = 0;
    for (int i = 0; i < 400; ++i) {  // 10 minutes
        bench.say(bench.board.reboot());
        bench.pass(1500ms);
    }
    EXPECT_LE(bench.logged, 16u) << testing::PrintToString(bench.notices);
    EXPECT_THAT(bench.notices, Contains(HasSubstr("restarted 40 times in the last minute")));
    EXPECT_THAT(warnings_of(bench, "uno1"), Contains(HasSubstr("restarted 40 times in the last minute")));
    bench.pass(130s);
    EXPECT_THAT(warnings_of(bench, "uno1"), IsEmpty());
}

TEST(WhichBoard, RestartsAgainAndAgain_TheWarningSaysHowOften) {
    OnlineBench bench;
    for (int i = 0; i < 15; ++i) {
        bench.say(bench.board.reboot());
        bench.pass(2s);
    }
    bench.pass(5s);
    EXPECT_THAT(warnings_of(bench, "uno1"), Contains(HasSubstr("restarted 15 times in the last minute")));
    bench.pass(60s);
    EXPECT_THAT(warnings_of(bench, "uno1"), IsEmpty());
}

TEST(WhichBoard, RestartsOnce_IsToldAsBefore) {
    OnlineBench bench;
    bench.notices.clear();
    bench.say(bench.board.reboot());
    bench.pass(5s);
    EXPECT_THAT(bench.notices, Contains("board restarted by itself"));
    EXPECT_THAT(bench.notices, Contains("board back"));
    EXPECT_THAT(warnings_of(bench, "uno1"), IsEmpty());
}

const std::string kInUse = "/dev/ttyACM0 is in use by another program; close it there first";

BridgeOptions of_a_service() {
    auto options = BridgeBench::defaults();
    options.announce_unreached = true;
    return options;
}

void fail_to_open(BridgeBench& bench, model::StateReason reason) {
    bench.run([&](Effects& out) {
        bench.bridge.unreached(reason, kInUse, {"serial", "/dev/ttyACM0", 0}, bench.now, out);
    });
}

model::Description described(const BridgeBench& bench) {
    return model::parse_description(bench.on("asip/servicebus/uno1/$description").back()).value();
}

TEST(WhichBoard, PortInUseAtTheStart_IsAnnouncedWithItsReasonUntilTheBoardIsFound) {
    BridgeBench bench(of_a_service());
    bench.board.services = "ISDM";
    bench.board.replies["#,N"] = "@#,N,4,{I:ASIP core IO,S:Servos,D:Distance,M:Motors}";
    fail_to_open(bench, model::StateReason::kReleased);
    bench.connect();
    bench.pass(1500ms);
    EXPECT_THAT(bench.on("asip/servicebus/uno1/$state"), testing::ElementsAre("lost"));
    EXPECT_THAT(described(bench).warnings, testing::ElementsAre(kInUse));
    EXPECT_EQ(described(bench).state->reason, model::StateReason::kReleased);
    EXPECT_EQ(described(bench).link.path, "/dev/ttyACM0");
    const auto refused = bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}});
    EXPECT_EQ(refused["reason"], "board-not-there");
    fail_to_open(bench, model::StateReason::kReleased);
    const auto said = bench.on("asip/servicebus/uno1/$description").size();
    bench.pass(2s);
    EXPECT_EQ(bench.on("asip/servicebus/uno1/$description").size(), said) << "it is said once";
    bench.plug();
    bench.pass(3s);
    EXPECT_EQ(bench.on("asip/servicebus/uno1/$state").back(), "online");
    EXPECT_THAT(described(bench).warnings, IsEmpty());
    EXPECT_FALSE(described(bench).services.empty());
    EXPECT_THAT(bench.board.executed, Contains("M,S")) << "made safe, as any board that is found first";
}

TEST(WhichBoard, PortInUseWhenItComesBack_IsTheReasonInPlaceOfTheCable) {
    OnlineBench bench(of_a_service());
    bench.unplug();
    fail_to_open(bench, model::StateReason::kUnplugged);
    EXPECT_EQ(described(bench).state->reason, model::StateReason::kUnplugged);
    fail_to_open(bench, model::StateReason::kReleased);
    EXPECT_EQ(described(bench).state->reason, model::StateReason::kReleased);
    bench.pass(2s);
    EXPECT_THAT(described(bench).warnings, testing::ElementsAre(kInUse));
    bench.plug();
    bench.pass(3s);
    EXPECT_THAT(described(bench).warnings, IsEmpty());
}

TEST(WhichBoard, PortInUse_OfAnAgentAtATerminalOrWithoutANameIsNotAnnounced) {
    for (auto options : {BridgeBench::defaults(), without_name()}) {
        options.announce_unreached = options.name.empty();
        BridgeBench bench(options);
        fail_to_open(bench, model::StateReason::kReleased);
        bench.connect();
        bench.pass(2s);
        EXPECT_THAT(bench.published, IsEmpty());
        EXPECT_EQ(bench.bridge.why_unreached(), kInUse);
    }
}

TEST(WhichBoard, NothingAnswersAtThePortOfAService_IsAnnouncedAndAskedOn) {
    BridgeBench bench(of_a_service());
    bench.board.mute = true;
    bench.plug();
    bench.pass(20s);
    bench.connect();
    bench.pass(2s);
    EXPECT_FALSE(bench.fatal);
    EXPECT_EQ(described(bench).state->reason, model::StateReason::kSilent);
    EXPECT_THAT(described(bench).warnings, testing::ElementsAre(HasSubstr("does not answer")));
    bench.board.mute = false;
    bench.pass(5s);
    EXPECT_EQ(bench.on("asip/servicebus/uno1/$state").back(), "online");
    EXPECT_THAT(described(bench).warnings, IsEmpty());
}

}  // namespace
}  // namespace asip::agent
