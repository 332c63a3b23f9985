// SPDX-License-Identifier: Apache-2.0
// The board's port in other hands: which user has it, until when, and what state is told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/agent/online_bridge.hpp"

namespace asip::agent {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kIn = "asip/uno1/in";

struct ReleasedPortTest : OnlineBridge {
    json ask(const json& request, const std::string& by = "ann") {
        auto message = request;
        message["by"] = by;
        return bench.ask(kIn, message, std::to_string(++asked));
    }
    json release(int seconds = 60, const std::string& by = "ann") {
        return ask({{"port", "release"}, {"seconds", seconds}}, by);
    }
    json take() { return ask({{"port", "take"}}); }
    std::string state() const {
        const auto states = bench.on("asip/servicebus/uno1/$state");
        return states.empty() ? "online" : states.back();
    }
    json description() const { return json::parse(bench.on("asip/servicebus/uno1/$description").back()); }
    json last_answer() const { return json::parse(bench.on("answers").back()); }
    int asked = 0;
};

TEST_F(ReleasedPortTest, Release_LetsGoAndSaysWhoAndUntilWhen) {
    const auto answer = release();
    EXPECT_EQ(answer["status"], "ok");
    EXPECT_EQ(answer["answer"]["path"], "/dev/ttyACM0");
    EXPECT_EQ(bench.port, Effects::Port::kLetGo);
    EXPECT_EQ(state(), "updating");
    bench.pass(1s);
    EXPECT_EQ(description()["updating"]["by"], "ann");
    EXPECT_EQ(description()["updating"]["until"], answer["answer"]["until"]);
    const auto refused = bench.ask("asip/uno1/io/in", {{"write", {13, 1}}});
    EXPECT_EQ(refused["status"], "refused");
    EXPECT_EQ(refused["reason"], "board-not-there");
}

TEST_F(ReleasedPortTest, GivenBack_TheBoardIsAskedAndBothSketchesAreTold) {
    release();
    bench.ask(kIn, {{"port", "take"}, {"by", "ann"}}, "back");
    EXPECT_EQ(bench.port, Effects::Port::kTakeBack);
    bench.board.sketch = "New";
    bench.plug();
    bench.pass(1s);
    const auto answer = last_answer();
    EXPECT_EQ(answer["id"], "back");
    EXPECT_EQ(answer["status"], "ok") << answer;
    EXPECT_EQ(answer["answer"]["same"], true);
    EXPECT_EQ(answer["answer"]["before"]["sketch"], "Script");
    EXPECT_EQ(answer["answer"]["after"]["sketch"], "New");
    EXPECT_EQ(state(), "online");
    EXPECT_FALSE(description().contains("updating"));
    EXPECT_EQ(take()["reason"], "not-released");
}

TEST_F(ReleasedPortTest, NeverGivenBack_IsTakenWhenTheTimeIsOver) {
    release(10);
    bench.pass(9999ms);
    EXPECT_EQ(bench.port, Effects::Port::kLetGo);
    bench.pass(2ms);
    EXPECT_EQ(bench.port, Effects::Port::kTakeBack);
    EXPECT_THAT(bench.notices, Contains(HasSubstr("not given back in time")));
    bench.plug();
    bench.pass(1s);
    EXPECT_EQ(state(), "online");
    EXPECT_EQ(release()["status"], "ok") << "and again";
}

TEST_F(ReleasedPortTest, Prolonged_ItIsTakenLater) {
    release(10);
    for (int i = 0; i < 5; ++i) {
        bench.pass(8s);
        EXPECT_EQ(release(10)["status"], "ok");
        EXPECT_EQ(bench.port, Effects::Port::kLetGo);
    }
    bench.pass(11s);
    EXPECT_EQ(bench.port, Effects::Port::kTakeBack);
}

TEST_F(ReleasedPortTest, SecondWhoAsks_IsRefusedAndToldWhoHasIt) {
    release(60, "ann");
    const auto answer = release(600, "bob");
    EXPECT_EQ(answer["reason"], "released");
    EXPECT_THAT(answer["error"].get<std::string>(), HasSubstr("ann"));
    bench.pass(61s);
    EXPECT_EQ(bench.port, Effects::Port::kTakeBack) << "not prolonged by bob";
    EXPECT_EQ(release(60, "bob")["reason"], "released") << "while it is being taken back";
}

TEST_F(ReleasedPortTest, BoardThatDoesNotAnswerAfterwards_IsLost) {
    release();
    bench.ask(kIn, {{"port", "take"}}, "back");
    bench.pass(21s);
    EXPECT_EQ(last_answer()["id"], "back");
    EXPECT_EQ(last_answer()["status"], "timeout");
    EXPECT_EQ(state(), "lost");
    bench.plug();
    bench.pass(1s);
    EXPECT_EQ(state(), "online") << "when it answers later";
}

TEST_F(ReleasedPortTest, AnotherBoardAtThePort_IsTold) {
    release();
    bench.ask(kIn, {{"port", "take"}}, "back");
    bench.board.chip = "ATmega2560";
    bench.plug();
    bench.pass(1s);
    const auto answer = last_answer();
    EXPECT_EQ(answer["answer"]["same"], false) << answer;
    EXPECT_THAT(bench.notices, Contains(HasSubstr("another board answers")));
}

TEST_F(ReleasedPortTest, Hold_IsUndoneBeforeThePortIsLetGo) {
    bench.hear("asip/uno1/io/in", R"({"write":[13,1],"hold_ms":5000,"id":"h","reply_to":"me"})");
    bench.board.executed.clear();
    release();
    bench.pass(600ms);
    EXPECT_THAT(bench.board.executed, ElementsAre("I,d,13,0"));
    EXPECT_EQ(bench.port, Effects::Port::kLetGo);
}

TEST_F(ReleasedPortTest, ReleaseThatWaitedLongerThanItsDeadline_IsNotDone) {
    const auto arrives = [&](const char* id, std::optional<std::uint32_t> expiry, Duration ago) {
        mqtt::Message message{
            .topic = kIn,
            .payload =
                json{
                    {"port", "release"}, {"seconds", 600}, {"by", "ann"}, {"id", id}, {"reply_to", "answers"}}
                    .dump(),
            .expiry_seconds = expiry};
        Effects out;
        bench.bridge.take(bench.bridge.read(message, bench.now - ago).value(), bench.now, out);
        return out;
    };
    bench.pass(1min);
    for (const auto& late : {arrives("1", std::nullopt, 5s), arrives("2", 2, 2s)}) {
        ASSERT_EQ(late.publish.size(), 1u);
        EXPECT_EQ(json::parse(late.publish[0].message.payload)["status"], "timeout");
        EXPECT_EQ(late.port, Effects::Port::kKeep);
    }
    EXPECT_EQ(state(), "online");
    EXPECT_TRUE(arrives("3", 3, 2s).publish.empty()) << "the line is given back first";
    bench.pass(1s);
    EXPECT_EQ(state(), "updating");
}

TEST_F(ReleasedPortTest, FaultyRequests_AreRefusedAndNothingHappens) {
    for (const auto* request : {R"({"port":"give"})", R"({"port":7})", R"({"port":"release","seconds":0})",
                                R"({"port":"release","seconds":3601})", R"({"port":"release","second":5})"}) {
        const auto answer = ask(json::parse(request));
        EXPECT_EQ(answer["status"], "refused") << request;
        EXPECT_EQ(answer["reason"], "invalid") << request;
    }
    bench.hear(kIn, R"({"port":"release"})", true);
    EXPECT_EQ(bench.port, Effects::Port::kKeep) << "retained";
    EXPECT_EQ(state(), "online");
}

TEST_F(ReleasedPortTest, WithoutTheBus_TheTimeRunsOnAll) {
    release(10);
    bench.bridge.bus_disconnected();
    bench.pass(11s);
    EXPECT_EQ(bench.port, Effects::Port::kTakeBack);
}

TEST(MayBeSameBoard, UnknownTraits_DoNotTellApart) {
    EXPECT_TRUE(may_be_same_board({"ATmega328P", "A", ""}, {"ATmega328P", "B", "uno1"}));
    EXPECT_TRUE(may_be_same_board({"", "A", "uno1"}, {"ATmega328P", "", "uno1"}));
    EXPECT_FALSE(may_be_same_board({"ATmega328P", "A", ""}, {"ATmega2560", "A", ""}));
    EXPECT_FALSE(may_be_same_board({"ATmega328P", "A", "uno1"}, {"ATmega328P", "A", "uno2"}));
}

}  // namespace
}  // namespace asip::agent
