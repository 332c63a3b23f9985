// SPDX-License-Identifier: Apache-2.0
// Each rule of docs/links.md about presses and times.
#include "tests/unit/links/rules_bench.hpp"

namespace asip::links {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(RulesTest, Toggles_OnceForEachPress) {
    add(link(When::kToggles));
    press();
    press();
    press(ButtonAct::kRelease);
    press();
    EXPECT_THAT(sent, ElementsAre(true, false, true));
}

TEST_F(RulesTest, Toggles_TwoPressesAtOnce) {
    add(link(When::kToggles));
    rules.act("desk", "io/2", ButtonAct::kPress, now);
    rules.act("desk", "io/2", ButtonAct::kPress, now);
    run();
    EXPECT_THAT(sent, ElementsAre(true, false));
}

TEST_F(RulesTest, Toggles_FromHowTheTargetStoodBeforeTheAgentBegan) {
    add(link(When::kToggles));
    press();
    restart();
    press();
    EXPECT_THAT(sent, ElementsAre(true, false));
    person(true);
    restart();
    press();
    EXPECT_THAT(sent, ElementsAre(true, false, false));
    target["io/13"] = std::nullopt;
    rules.target_back();  // the board restarted: it is off
    press();
    EXPECT_THAT(sent, ElementsAre(true, false, false, true));
}

TEST_F(RulesTest, Toggles_TwoPressesBeforeTheAnswer) {
    answers = executes = false;
    add(link(When::kToggles));
    press();
    press();
    EXPECT_THAT(sent, ElementsAre(true, false));
}

TEST_F(RulesTest, Toggles_NothingIsMadeUpFor) {
    add(link(When::kToggles));
    ready = false;
    press();
    ready = true;
    rules.target_back();
    run();
    pass(1h);
    EXPECT_THAT(sent, IsEmpty());
    EXPECT_THAT(cause(), HasSubstr("not there"));
}

TEST_F(RulesTest, Toggles_BetweenTwoValues) {
    target["servo/0/angle"] = 0;
    auto made = link(When::kToggles);
    made.target = "servo/0/angle";
    made.value = 90;
    made.otherwise = 0;
    add(made);
    press();
    press();
    EXPECT_THAT(sent, ElementsAre(90, 0));
}

TEST_F(RulesTest, Events_EachSetsTheValue) {
    auto made = link(When::kDouble);
    made.value = false;
    add(made);
    press();
    press(ButtonAct::kDouble);
    press(ButtonAct::kHold);
    EXPECT_THAT(sent, ElementsAre(false));
}

TEST_F(RulesTest, After_OnlyWhatLasts) {
    auto made = link();
    made.after = 5s;
    add(made);
    source(false);
    source(true);
    pass(4s);
    source(false);
    pass(10s);
    EXPECT_THAT(sent, IsEmpty());
    source(true);
    pass(5s);
    EXPECT_THAT(sent, ElementsAre(true));
    source(false);
    EXPECT_THAT(sent, ElementsAre(true, false)) << "the end needs no time";
}

TEST_F(RulesTest, For_BackAgain) {
    auto made = link();
    made.lasts = 10s;
    add(made);
    source(true);
    pass(9s);
    EXPECT_THAT(sent, ElementsAre(true));
    pass(2s);
    EXPECT_THAT(sent, ElementsAre(true, false));
    rules.target_back();
    run();
    pass(1h);
    EXPECT_EQ(sent.size(), 2U);
    source(false);
    source(true);
    EXPECT_EQ(sent.size(), 3U);
}

TEST_F(RulesTest, For_APersonEndsIt) {
    auto made = link(When::kPress);
    made.lasts = 10s;
    add(made);
    press();
    person(true);
    pass(1min);
    EXPECT_THAT(sent, ElementsAre(true));
}

TEST_F(RulesTest, For_EndsAlsoWhileTheSourceIsNotThere) {
    auto made = link();
    made.lasts = 10s;
    add(made);
    source(true);
    rules.present("desk", false, now);
    source(std::nullopt);
    pass(1min);
    EXPECT_THAT(sent, ElementsAre(true, false));
    restart();
    pass(1min);
    EXPECT_EQ(sent.size(), 2U);
}

TEST_F(RulesTest, After_ARestartIsNoTimeThatPassed) {
    auto made = link();
    made.after = 5s;
    add(made);
    source(true);
    pass(1s);
    restart();
    source(true);
    pass(4s);
    EXPECT_THAT(sent, IsEmpty());
    pass(2s);
    EXPECT_THAT(sent, ElementsAre(true));
}

TEST_F(RulesTest, For_OfAPressIsBroughtToItsEndByTheNextAgent) {
    auto made = link(When::kPress);
    made.lasts = 10s;
    add(made);
    press();
    pass(5s);
    restart();
    pass(1min);
    EXPECT_THAT(sent, ElementsAre(true, false));
}

TEST_F(RulesTest, Between_OutsideItIsOff) {
    auto made = link();
    made.between = {22 * 60, 6 * 60};
    add(made);
    source(true);
    EXPECT_THAT(sent, IsEmpty());
    pass(10h + 2min);
    EXPECT_THAT(sent, ElementsAre(true));
    pass(8h);
    EXPECT_THAT(sent, ElementsAre(true, false));
}

TEST_F(RulesTest, Between_EventsOutsideDoNothing) {
    auto made = link(When::kToggles);
    made.between = {22 * 60, 6 * 60};
    add(made);
    press();
    EXPECT_THAT(sent, IsEmpty());
    second_of_day = 23 * 3600;
    press();
    EXPECT_THAT(sent, ElementsAre(true));
}

}  // namespace
}  // namespace asip::links
