// SPDX-License-Identifier: Apache-2.0
#include "bench/load/script.hpp"

#include <gmock/gmock.h>

#include <fstream>

namespace asip::load {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

std::string fault_of(const std::string& text) {
    const auto step = parse_step(text);
    return step ? "" : step.error();
}

TEST(Step, WithEveryPart_IsRead) {
    const auto step = parse_step("  30s  flap 1%\tover 2s down 500ms every 10s ");
    ASSERT_TRUE(step) << step.error();
    EXPECT_EQ(step->at, 30s);
    EXPECT_EQ(step->verb, Verb::kFlap);
    EXPECT_EQ(step->amount.of(1000), 10u);
    EXPECT_EQ(step->over, 2s);
    EXPECT_EQ(step->down, 500ms);
    EXPECT_EQ(step->every, 10s);
}

TEST(Step, Amounts_AreANumberAPartOrAll) {
    EXPECT_EQ(parse_step("0s join 7")->amount.of(5), 5u) << "no more than there are";
    EXPECT_EQ(parse_step("0s join 7")->amount.of(9), 7u);
    EXPECT_EQ(parse_step("0s join 1%")->amount.of(50), 1u) << "at least one";
    EXPECT_EQ(parse_step("0s join 12.5%")->amount.of(80), 10u);
    EXPECT_EQ(parse_step("0s join all")->amount.of(80), 80u);
}

TEST(Step, Wrong_IsRefusedWithWhatMayStandThere) {
    EXPECT_THAT(fault_of("30s die"), HasSubstr("AT VERB BOARDS"));
    EXPECT_THAT(fault_of(""), HasSubstr("AT VERB BOARDS"));
    EXPECT_THAT(fault_of("soon die 5"), HasSubstr("soon"));
    EXPECT_THAT(fault_of("1s flop 5"), HasSubstr("did you mean \"flap\""));
    EXPECT_THAT(fault_of("1s die 0"), HasSubstr("100, 5% or all"));
    EXPECT_THAT(fault_of("1s die -3"), HasSubstr("100, 5% or all"));
    EXPECT_THAT(fault_of("1s die 101%"), HasSubstr("100, 5% or all"));
    EXPECT_THAT(fault_of("1s die 5 evry 3s"), HasSubstr("did you mean \"every\""));
    EXPECT_THAT(fault_of("1s die 5 over"), HasSubstr("AT VERB BOARDS"));
    EXPECT_THAT(fault_of("1s die 5 over x"), HasSubstr("over: "));
    EXPECT_THAT(fault_of("1s die 5 over 3s every 2s"), HasSubstr("shorter than over"));
    EXPECT_THAT(fault_of("1s die 5 every 1ms"), HasSubstr("shorter than 10ms"));
    EXPECT_THAT(fault_of("1s die 5 down 10s"), HasSubstr("only boards that flap come back"));
    EXPECT_THAT(fault_of("1s die 5 over 1s over 2s"), HasSubstr("given twice"));
}

class ScriptFile : public testing::Test {
  protected:
    std::string write(const std::string& text) {
        const std::string path = testing::TempDir() + "asip-load-script-" + std::to_string(getpid());
        std::ofstream(path) << text;
        return path;
    }
};

TEST_F(ScriptFile, CommentsAndEmptyLines_AreSkipped) {
    const auto steps =
        read_script(write("# all of it\n\n0s join all over 5s\n30s die 5  # by a cut cable\r\n"));
    ASSERT_TRUE(steps) << steps.error();
    ASSERT_EQ(steps->size(), 2u);
    EXPECT_EQ(steps->at(1).verb, Verb::kDie);
}

TEST_F(ScriptFile, Fault_IsNamedWithItsLine) {
    EXPECT_THAT(read_script(write("0s join all\n3s fly 5\n")).error(), HasSubstr(":2: \"fly\""));
    EXPECT_THAT(read_script(write("# nothing\n")).error(), HasSubstr("has no steps"));
    EXPECT_THAT(read_script("/no/such/file").error(), HasSubstr("/no/such/file"));
}

Plan plan_of(const std::vector<std::string>& steps, std::size_t boards = 100) {
    std::vector<Step> all;
    for (const auto& text : steps)
        all.push_back(*parse_step(text));
    return Plan(all, boards);
}

std::size_t due_at(Plan& plan, Duration now, bool settled = false) {
    std::size_t count = 0;
    for (const auto& due : plan.due(now, settled))
        count += due.count;
    return count;
}

TEST(Plan, StepWithoutOver_IsDueAtOnceAndOnce) {
    auto plan = plan_of({"5s die 10"});
    EXPECT_EQ(plan.next(0s), 5s);
    EXPECT_EQ(due_at(plan, 4999ms), 0u);
    EXPECT_EQ(due_at(plan, 5s), 10u);
    EXPECT_EQ(due_at(plan, 50s), 0u);
    EXPECT_EQ(plan.next(50s), std::nullopt);
}

TEST(Plan, StepOverATime_IsSpreadAndComplete) {
    auto plan = plan_of({"0s join all over 10s"});
    std::size_t joined = due_at(plan, 0s);
    EXPECT_EQ(joined, 0u);
    joined += due_at(plan, 5s);
    EXPECT_EQ(joined, 50u);
    EXPECT_EQ(plan.next(5s), 5100ms);
    joined += due_at(plan, 5100ms);
    EXPECT_EQ(joined, 51u);
    joined += due_at(plan, 60s);
    EXPECT_EQ(joined, 100u);
    EXPECT_EQ(plan.next(60s), std::nullopt);
}

TEST(Plan, StepWithEvery_ComesAgainAndAgain) {
    auto plan = plan_of({"10s flap 5 every 10s"});
    EXPECT_EQ(due_at(plan, 10s), 5u);
    EXPECT_EQ(plan.next(10s), 20s);
    EXPECT_EQ(due_at(plan, 19s), 0u);
    EXPECT_EQ(due_at(plan, 20s), 5u);
    EXPECT_EQ(due_at(plan, 50s), 15u) << "what was missed is made up for";
    EXPECT_EQ(plan.next(50s), 60s);
}

TEST(Plan, FollowedByItsOwnTimes_DoesEverythingWithoutSpinning) {
    auto plan = plan_of({"0s join all over 3s", "1s die 7 over 1s every 2s"});
    Duration now{};
    std::size_t asked = 0, done = 0;
    for (; asked < 1000 && now < 10s; ++asked) {
        done += due_at(plan, now);
        now = std::max(now, plan.next(now).value());
    }
    EXPECT_LT(asked, 200u);
    EXPECT_GE(done, 100u + 4 * 7);
}

TEST(Plan, TwoStepsAtOneTime_AreDueInTheOrderOfTheScript) {
    auto plan = plan_of({"1s die 5", "1s join 5"});
    const auto due = plan.due(1s, false);
    ASSERT_EQ(due.size(), 2u);
    EXPECT_EQ(due[0].verb, Verb::kDie);
    EXPECT_EQ(due[1].verb, Verb::kJoin);
}

TEST(Step, Then_IsReadWithATimeOrWithout) {
    EXPECT_FALSE(parse_step("5s die 1")->then);
    EXPECT_TRUE(parse_step("then die 1")->then);
    EXPECT_EQ(parse_step("then die 1")->at, 0s);
    EXPECT_EQ(parse_step("then+2s die 1")->at, 2s);
    EXPECT_THAT(fault_of("then+ die 1"), HasSubstr("AT VERB BOARDS"));
    EXPECT_THAT(fault_of("then2s die 1"), HasSubstr("then2s"));
}

TEST(Plan, StepsWithThen_WaitForTheOnesBeforeAndForSettledBoards) {
    auto plan = plan_of({"0s join all over 2s", "then die 10", "then+3s flap 20", "20s leave 5"});
    EXPECT_EQ(due_at(plan, 1s, true), 50u) << "not all have joined";
    EXPECT_EQ(due_at(plan, 2s, true), 50u);
    EXPECT_EQ(due_at(plan, 3s, false), 0u) << "they are not announced";
    EXPECT_EQ(plan.next(3s), 3020ms);
    EXPECT_EQ(due_at(plan, 4s, true), 10u) << "one step at a time";
    EXPECT_EQ(due_at(plan, 5s, true), 0u);
    EXPECT_EQ(plan.next(5s), 8s);
    EXPECT_EQ(due_at(plan, 8s), 20u);
    EXPECT_EQ(plan.next(8s), 20s);
    EXPECT_EQ(due_at(plan, 20s), 5u);
    EXPECT_EQ(plan.next(20s), std::nullopt);
}

TEST(Plan, StepWithATimeBehindOneThatWaits_IsDueAtItsTime) {
    auto plan = plan_of({"then die 10", "1s leave 5", "then join 3"});
    EXPECT_EQ(due_at(plan, 1s), 5u);
    EXPECT_EQ(due_at(plan, 2s, true), 10u);
    EXPECT_EQ(due_at(plan, 2s, true), 3u);
}

}  // namespace
}  // namespace asip::load
