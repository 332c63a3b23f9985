// SPDX-License-Identifier: Apache-2.0
// Each rule of docs/links.md.
#include "asip/links/rules.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace asip::links {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using property::ButtonAct;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A lamp that obeys, with the links that set it.
class RulesTest : public testing::Test {
  protected:
    Rules rules{
        {.value = [this](const std::string& id) { return target.contains(id) ? target[id] : std::nullopt; },
         .ready = [this] { return ready; },
         .second_of_day = [this] { return second_of_day; },
         .dangerous = [](const Link& link) { return link.target.starts_with("motors"); }}};
    std::map<std::string, std::optional<json>> target{{"io/13", json(false)}};
    bool ready = true;
    int second_of_day = 12 * 3600;
    Time now{};
    std::vector<json> sent;  // values in order; "safe" and commands by their kind
    std::vector<Order> orders;

    static Link link(When when = When::kFollows) {
        Link made;
        made.name = "l";
        made.board = "desk";
        made.source = "io/2";
        made.target = "io/13";
        made.when = when;
        return made;
    }
    void add(const Link& made, Kept kept = {}) { rules.set(made, std::move(kept), now); }
    void run() {
        for (const auto& order : rules.run(now)) {
            orders.push_back(order);
            sent.push_back(order.kind == Order::Kind::kSafe ? json("safe") : order.value);
            if (executes) {
                const auto& of = rules.links().at(order.link).link.target;
                target[of] = order.kind == Order::Kind::kSafe ? json(0) : order.value;
                rules.executed(of, order.link);
            }
            if (answers) rules.finished(order.link, executes, "no answer");
        }
    }
    void source(const std::optional<json>& value) {
        rules.source("desk", "io/2", value, now);
        run();
    }
    void press(ButtonAct act = ButtonAct::kPress) {
        rules.act("desk", "io/2", act, now);
        run();
    }
    void person(const json& value) {
        target["io/13"] = value;
        rules.executed("io/13", "");
        run();
    }
    void pass(Duration time) {
        const auto end = now + time;
        int wakes = 0;
        while (const auto due = rules.next_deadline()) {
            if (*due > end) break;
            ASSERT_LT(++wakes, 5000) << "it wakes for nothing";
            second_of_day = (second_of_day + static_cast<int>((std::max(*due, now) - now) / 1s)) % 86400;
            now = std::max(*due, now) + 1us;
            run();
        }
        now = end;
    }
    /// The agent ends, and another one begins with what was kept.
    void restart() {
        const auto kept = rules.links();
        auto world = Rules::World{
            [this](const std::string& id) { return target.contains(id) ? target[id] : std::nullopt; },
            [this] { return ready; }, [this] { return second_of_day; }, [](const Link&) { return false; }};
        rules = Rules(std::move(world));
        for (const auto& [name, entry] : kept)
            rules.set(entry.link, entry.kept, now);
        target["io/13"] = std::nullopt;
        rules.target_back();
        run();
    }
    std::string cause() const { return rules.links().at("l").cause; }
    bool executes = true, answers = true;
};

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
