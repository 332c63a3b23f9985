// SPDX-License-Identifier: Apache-2.0
// Each rule of docs/links.md about levels, persons, stops and sources.
#include "tests/unit/links/rules_bench.hpp"

namespace asip::links {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(RulesTest, Follows_OneCommandForEachChange) {
    add(link());
    source(true);
    source(true);
    source(false);
    EXPECT_THAT(sent, ElementsAre(true, false));
    EXPECT_EQ(orders[0].because, "desk/io/2 was on");
    EXPECT_EQ(cause(), "set to off, because desk/io/2 was off");
}

TEST_F(RulesTest, Follows_WhatIsSoAlreadyIsNotSent) {
    target["io/13"] = true;
    add(link());
    source(true);
    EXPECT_THAT(sent, IsEmpty());
}

TEST_F(RulesTest, Inverted) {
    add(link(When::kInverted));
    source(true);
    EXPECT_THAT(sent, IsEmpty());
    source(false);
    EXPECT_THAT(sent, ElementsAre(true));
}

TEST_F(RulesTest, PersonWins_UntilTheSourceChanges) {
    add(link());
    source(true);
    person(false);
    source(true);
    rules.target_back();
    run();
    pass(1h);
    EXPECT_THAT(sent, ElementsAre(true));
    source(false);  // the target is off already
    source(true);
    EXPECT_THAT(sent, ElementsAre(true, true));
}

TEST_F(RulesTest, PersonWins_IsKeptOverARestart) {
    add(link());
    source(true);
    person(false);
    restart();
    source(true);
    EXPECT_THAT(sent, ElementsAre(true));
}

TEST_F(RulesTest, Returns_TheTargetIsMadeTrueOnce) {
    add(link());
    source(true);
    target["io/13"] = std::nullopt;
    rules.target_back();
    run();
    run();
    EXPECT_THAT(sent, ElementsAre(true, true));
}

TEST_F(RulesTest, Returns_AgentMakesItTrueOnceTheSourceIsHeard) {
    add(link());
    source(true);
    restart();
    EXPECT_THAT(sent, ElementsAre(true));
    source(true);
    EXPECT_THAT(sent, ElementsAre(true, true));
}

TEST_F(RulesTest, Returns_AnotherValueOfTheSourceCounts) {
    add(link());
    source(true);
    source(std::nullopt);
    source(false);
    EXPECT_THAT(sent, ElementsAre(true, false));
}

TEST_F(RulesTest, Failed_IsNotRepeated) {
    executes = false;
    add(link());
    source(true);
    pass(1h);
    EXPECT_THAT(sent, ElementsAre(true));
    EXPECT_THAT(cause(), HasSubstr("no answer"));
    rules.target_back();
    run();
    EXPECT_EQ(sent.size(), 2U);
}

TEST_F(RulesTest, InFlight_TheLastValueIsSentThen) {
    answers = false;
    add(link());
    source(true);
    source(false);
    source(true);
    EXPECT_THAT(sent, ElementsAre(true));
    target["io/13"] = false;  // it came to nothing
    rules.finished("l", false, "no answer");
    run();
    EXPECT_THAT(sent, ElementsAre(true, true));
}

TEST_F(RulesTest, BoardAway_TheLastValueIsSentWhenItIsBack) {
    add(link());
    ready = false;
    source(true);
    EXPECT_THAT(sent, IsEmpty());
    ready = true;
    rules.target_back();
    run();
    EXPECT_THAT(sent, ElementsAre(true));
}

TEST_F(RulesTest, Stop_ResumeAloneSendsNothing) {
    add(link());
    source(true);
    target["io/13"] = false;
    rules.stopped(true);
    run();
    rules.resumed();
    rules.target_back();
    run();
    source(true);
    EXPECT_THAT(sent, ElementsAre(true));
    source(false);
    source(true);
    EXPECT_THAT(sent, ElementsAre(true, true));
}

TEST_F(RulesTest, Stop_NothingIsSentWhileItHolds) {
    add(link());
    rules.stopped(true);
    source(true);
    rules.resumed();
    run();
    pass(1h);
    EXPECT_THAT(sent, IsEmpty());
}

TEST_F(RulesTest, Above_WithHysteresis) {
    auto made = link(When::kAbove);
    made.level = 30;
    made.back = 28;
    add(made);
    for (const double value : {20.0, 30.0, 30.5, 29.0, 28.1, 31.0, 28.0, 29.0})
        source(value);
    EXPECT_THAT(sent, ElementsAre(true, false));
    EXPECT_EQ(orders[0].because, "desk/io/2 was 30.5");
}

TEST_F(RulesTest, Below_WithValues) {
    target["servo/0/angle"] = 90;
    auto made = link(When::kBelow);
    made.target = "servo/0/angle";
    made.level = 10;
    made.value = 180;
    add(made);
    source(20);
    source(5);
    source(20);
    EXPECT_THAT(sent, ElementsAre(180)) << "nothing says what it is otherwise";
}

TEST_F(RulesTest, Line_FromOneRangeToAnother) {
    target["servo/0/angle"] = std::nullopt;
    auto made = link();
    made.target = "servo/0/angle";
    made.line = {0, 1000, 180, 0};
    add(made);
    for (const int value : {0, 250, 2000})
        source(value);
    EXPECT_THAT(sent, ElementsAre(180, 135, 0));
}

TEST_F(RulesTest, SourceGone_TheTargetKeepsItsValue) {
    add(link());
    source(true);
    rules.present("desk", false, now);
    source(std::nullopt);
    pass(1h);
    EXPECT_THAT(sent, ElementsAre(true));
}

TEST_F(RulesTest, SourceGone_MotorsAreMadeSafeOnce) {
    target["motors/0/power"] = 0;
    auto made = link();
    made.target = "motors/0/power";
    made.value = 50;
    made.otherwise = 0;
    add(made);
    rules.present("desk", false, now);
    pass(1min);
    EXPECT_THAT(sent, IsEmpty()) << "it was not heard yet";
    rules.present("desk", true, now);
    source(true);
    rules.present("desk", false, now);
    pass(900ms);
    EXPECT_THAT(sent, ElementsAre(50));
    pass(1h);
    EXPECT_THAT(sent, ElementsAre(50, "safe"));
    rules.present("desk", true, now);
    source(true);
    EXPECT_THAT(sent, ElementsAre(50, "safe", 50));
}

TEST_F(RulesTest, SourceGone_AMomentDoesNotCount) {
    auto made = link();
    made.safe = true;
    add(made);
    source(true);
    rules.present("desk", false, now);
    pass(900ms);
    rules.present("desk", true, now);
    source(true);
    pass(1h);
    EXPECT_THAT(sent, ElementsAre(true));
}

TEST_F(RulesTest, Flood_TwentyASecond) {
    add(link());
    for (int i = 0; i < 1000; ++i) {
        source(i % 2 == 0);
        pass(1ms);
    }
    EXPECT_LE(sent.size(), 21U);
    EXPECT_THAT(cause(), HasSubstr("more than 20 commands a second"));
    source(true);
    pass(2s);
    EXPECT_EQ(sent.back(), true) << "the last value counts";
}

TEST_F(RulesTest, TwoLinks_TheOneWhoseSourceChangedLastCounts) {
    auto other = link();
    other.name = "m";
    other.source = "io/3";
    add(link());
    add(other);
    source(true);
    rules.source("desk", "io/3", json(false), now);
    run();
    EXPECT_THAT(sent, ElementsAre(true, false));
    restart();
    source(true);
    rules.source("desk", "io/3", json(false), now);
    run();
    EXPECT_EQ(target["io/13"], json(false));
}

TEST_F(RulesTest, Disabled_DoesNothing) {
    add(link());
    rules.enable("l", false);
    source(true);
    EXPECT_THAT(sent, IsEmpty());
    rules.enable("l", true);
    source(false);
    source(true);
    EXPECT_THAT(sent, ElementsAre(true));
}

TEST_F(RulesTest, Disabled_TheSourceChangesMeanwhile) {
    add(link());
    source(true);
    rules.enable("l", false);
    source(false);
    target["io/13"] = false;
    rules.enable("l", true);
    run();
    EXPECT_THAT(sent, ElementsAre(true));
    source(true);
    EXPECT_THAT(sent, ElementsAre(true, true));
}

TEST_F(RulesTest, Disabled_WhatItBeganIsLeftAsItIs) {
    auto made = link(When::kPress);
    made.lasts = 10s;
    add(made);
    press();
    rules.enable("l", false);
    restart();
    pass(1min);
    EXPECT_THAT(sent, ElementsAre(true));
    made.enabled = false;
    add(made, {true, false, false});  // as earlier builds kept it
    pass(1min);
    EXPECT_FALSE(rules.next_deadline());
    rules.enable("l", true);
    EXPECT_FALSE(rules.links().at("l").kept.suspended) << "it waits for no change";
}

TEST_F(RulesTest, Command_IsSentOnceForEachBeginning) {
    auto made = link(When::kAbove);
    made.level = 10;
    made.target = "tone";
    made.command = {{"play", {440, 200}}};
    add(made);
    for (const int value : {5, 20, 21, 5, 20})
        source(value);
    ASSERT_EQ(orders.size(), 2U);
    EXPECT_EQ(orders[0].kind, Order::Kind::kCommand);
    rules.target_back();
    restart();
    source(21);
    EXPECT_EQ(orders.size(), 2U) << "a restart sends it again";
}

}  // namespace
}  // namespace asip::links
