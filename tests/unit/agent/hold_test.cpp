// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/agent/online_bridge.hpp"

namespace asip::agent {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr const char* kIo = "asip/uno1/io/in";

struct HoldTest : OnlineBridge {
    /// The last answer.
    json hear(const json& command, const std::string& client = "me", const char* topic = kIo) {
        auto message = command;
        message["reply_to"] = client;
        bench.hear(topic, message.dump());
        const auto answers = bench.on(client);
        return answers.empty() ? json() : json::parse(answers.back());
    }
    json hold(int pin = 13, const std::string& client = "me", const std::string& id = "h") {
        return hear({{"write", {pin, 1}}, {"hold_ms", 500}, {"id", id}}, client);
    }
    json renew(const json& which = "h", const std::string& client = "me") {
        return hear({{"renew", which}}, client);
    }
    json last_error() const {
        const auto errors = bench.on("asip/uno1/io/error");
        return errors.empty() ? json() : json::parse(errors.back());
    }
    const std::vector<std::string>& executed() const { return bench.board.executed; }
};

TEST_F(HoldTest, NotRenewed_IsUndoneAtTheEndOfItsTime) {
    EXPECT_EQ(hold()["status"], "ok");
    bench.pass(499ms);
    EXPECT_THAT(executed(), ElementsAre("I,d,13,1"));
    bench.pass(1ms);
    EXPECT_THAT(executed(), ElementsAre("I,d,13,1", "I,d,13,0"));
    EXPECT_EQ(last_error()["request"], "d,13,1");
    EXPECT_EQ(last_error()["reason"], "not-renewed");
    EXPECT_THAT(last_error()["error"].get<std::string>(),
                HasSubstr("not renewed within 500 ms; I,d,13,0 was executed"));
    bench.pass(10s);
    EXPECT_EQ(executed().size(), 2u) << "once";
}

TEST_F(HoldTest, UndoingIsAlwaysRefused_IsReportedAfterThreeAttempts) {
    hold();
    bench.board.heard.clear();
    bench.board.replies["I,d,13,0"] = "~I,d,8{DEVICE_NOT_AVAILABLE}";
    bench.pass(10s);
    EXPECT_EQ(std::count(bench.board.heard.begin(), bench.board.heard.end(), "I,d,13,0"), 3);
    EXPECT_THAT(last_error()["error"].get<std::string>(), HasSubstr("was refused by the board"));
}

TEST_F(HoldTest, Renewed_StaysInForceUntilItIsNot) {
    hold();
    for (int i = 0; i < 20; ++i) {
        bench.pass(400ms);
        EXPECT_EQ(renew()["proof"], "renewed");
    }
    EXPECT_THAT(executed(), ElementsAre("I,d,13,1"));
    bench.pass(500ms);
    EXPECT_THAT(executed(), Contains("I,d,13,0"));
    EXPECT_EQ(renew()["reason"], "not-held");
}

TEST_F(HoldTest, RenewalWithAnotherTime_HoldsForThat) {
    hold();
    hear({{"renew", "h"}, {"hold_ms", 3000}});
    bench.pass(2900ms);
    EXPECT_THAT(executed(), Not(Contains("I,d,13,0")));
    bench.pass(100ms);
    EXPECT_THAT(executed(), Contains("I,d,13,0"));
}

TEST_F(HoldTest, RenewalThatWasDelayed_HoldsFromWhenItMayHaveCome) {
    hold();
    hear({{"renew", "h"}, {"hold_ms", 10'000}});
    bench.pass(7s);
    mqtt::Message late{.topic = kIo, .payload = R"({"renew":"h","reply_to":"me"})"};
    bench.hear(late, bench.now - 6s);
    EXPECT_EQ(json::parse(bench.on("me").back())["proof"], "renewed");
    bench.pass(3999ms);
    EXPECT_THAT(executed(), Not(Contains("I,d,13,0")));
    bench.pass(1ms);
    EXPECT_THAT(executed(), Contains("I,d,13,0"));
}

TEST_F(HoldTest, RenewalOfUnknownAge_ShortensNothing) {
    hold();
    bench.pass(400ms);
    renew();
    mqtt::Message late{.topic = kIo, .payload = R"({"renew":"h","reply_to":"me"})"};
    bench.hear(late, bench.now - 1s);
    bench.pass(499ms);
    EXPECT_THAT(executed(), Not(Contains("I,d,13,0")));
    bench.pass(1ms);
    EXPECT_THAT(executed(), Contains("I,d,13,0"));
}

TEST_F(HoldTest, RenewedByAnotherClient_IsRefusedAndUndone) {
    hold();
    bench.pass(400ms);
    const auto answer = renew("h", "somebody else");
    EXPECT_EQ(answer["status"], "refused");
    EXPECT_EQ(answer["reason"], "not-held");
    bench.pass(100ms);
    EXPECT_THAT(executed(), Contains("I,d,13,0"));
}

TEST_F(HoldTest, RenewTrue_RenewsAllOfThisClientAtThisService) {
    hold(12, "me", "a");
    hold(13, "me", "b");
    hold(11, "other", "c");
    bench.pass(400ms);
    EXPECT_EQ(renew(true)["status"], "ok");
    bench.pass(200ms);
    EXPECT_THAT(executed(), ElementsAre("I,d,12,1", "I,d,13,1", "I,d,11,1", "I,d,11,0"));
    bench.pass(300ms);
    EXPECT_EQ(executed().size(), 6u);
}

TEST_F(HoldTest, FullQueue_RenewalIsTakenAtOnce) {
    hold();
    bench.board.mute = true;
    for (int i = 0; i < 64; ++i)
        bench.hear("asip/uno1/servo/in", R"({"write":[0,1],"reply_to":"me"})");
    EXPECT_EQ(renew()["status"], "ok");
}

TEST_F(HoldTest, SameCommandHeldAgain_BeginsAnew) {
    hold(13, "me", "1");
    bench.pass(400ms);
    hold(13, "me", "2");
    bench.pass(400ms);
    EXPECT_THAT(executed(), ElementsAre("I,d,13,1", "I,d,13,1"));
    bench.pass(100ms);
    EXPECT_EQ(executed().back(), "I,d,13,0");
}

TEST_F(HoldTest, PlainCommandAfterwards_EndsTheHold) {
    hold();
    hear({{"write", {13, 1}}, {"id", "plain"}}, "other");
    bench.pass(10s);
    EXPECT_THAT(executed(), ElementsAre("I,d,13,1", "I,d,13,1")) << "its sender wants it to last";
    EXPECT_EQ(renew()["reason"], "not-held");
}

TEST_F(HoldTest, UndoneByItsSender_IsNotUndoneAgain) {
    hold();
    hear({{"write", {13, 0}}, {"id", "off"}});
    bench.pass(10s);
    EXPECT_THAT(executed(), ElementsAre("I,d,13,1", "I,d,13,0"));
}

TEST_F(HoldTest, UndoneByARawLine_IsNotUndoneAgain) {
    hold();
    bench.hear("asip/uno1/in", "I,d,13,0");
    bench.client_says("I,d,12,1");
    bench.pass(10s);
    EXPECT_THAT(executed(), ElementsAre("I,d,13,1", "I,d,13,0", "I,d,12,1"));
}

TEST_F(HoldTest, AnotherElementCommanded_TheHoldStays) {
    hold();
    hear({{"write", {12, 1}}, {"id", "plain"}});
    bench.pass(500ms);
    EXPECT_THAT(executed(), ElementsAre("I,d,13,1", "I,d,12,1", "I,d,13,0"));
}

TEST_F(HoldTest, HoldOfAnother_TakesItsPlace) {
    hold(13, "me", "1");
    bench.pass(400ms);
    hold(13, "other", "2");
    EXPECT_EQ(renew("1")["reason"], "not-held");
    bench.pass(500ms);
    EXPECT_EQ(executed().back(), "I,d,13,0");
    EXPECT_EQ(executed().size(), 3u);
}

TEST_F(HoldTest, BusGone_IsUndoneAllTheSame) {
    hold();
    bench.bridge.bus_disconnected();
    bench.pass(500ms);
    EXPECT_THAT(executed(), ElementsAre("I,d,13,1", "I,d,13,0"));
}

TEST_F(HoldTest, BoardGone_IsReportedAndUndoneAsSoonAsItIsBack) {
    hold();
    bench.unplug();
    EXPECT_THAT(last_error()["error"].get<std::string>(), HasSubstr("the board is not there"));
    EXPECT_EQ(renew()["reason"], "not-held") << "nobody knows what it does now";
    EXPECT_THAT(executed(), ElementsAre("I,d,13,1"));
    bench.pass(60s);
    bench.board.executed.clear();
    bench.plug();
    bench.pass(1s);
    ASSERT_FALSE(executed().empty());
    EXPECT_EQ(executed().front(), "I,d,13,0") << "before anything else";
}

TEST_F(HoldTest, BoardRestarts_WhatWasHeldIsNotRestored) {
    bench.ask(kIo, {{"mode", {12, "output"}}});
    bench.ask(kIo, {{"mode", {13, "output"}}}, "2");
    bench.ask(kIo, {{"write", {12, 1}}}, "3");
    hold();
    bench.board.executed.clear();
    bench.say(bench.board.reboot());
    bench.pass(10s);
    EXPECT_THAT(executed(), Contains("I,P,13,3"));
    EXPECT_THAT(executed(), Contains("I,d,12,1")) << "no hold";
    EXPECT_THAT(executed(), Not(Contains("I,d,13,1")));
}

TEST_F(HoldTest, EndsWhileTheBoardIsAway_IsNotRestored) {
    bench.ask(kIo, {{"mode", {13, "output"}}});
    hold();
    bench.unplug();
    bench.board.executed.clear();
    bench.board.reboot();
    bench.plug();
    bench.pass(10s);
    EXPECT_THAT(executed(), Contains("I,P,13,3"));
    EXPECT_THAT(executed(), Not(Contains("I,d,13,1")));
}

TEST_F(HoldTest, BoardRestarts_NothingIsHeldAnyMore) {
    hold();
    bench.say(bench.board.reboot());
    bench.pass(100ms);
    EXPECT_EQ(renew()["reason"], "not-held");
    EXPECT_THAT(last_error()["error"].get<std::string>(), HasSubstr("restarted"));
    bench.pass(10s);
    EXPECT_THAT(executed(), Not(Contains("I,d,13,0"))) << "pins are inputs again";
}

TEST_F(HoldTest, SafeFormLostOnTheLine_IsSentAgain) {
    hold();
    bench.pass(400ms);
    bench.board.lose_lines = 2;
    bench.pass(5s);
    EXPECT_THAT(executed(), Contains(HasSubstr("I,d,13,0")));
}

TEST_F(HoldTest, RefusedByTheBoard_IsNotHeld) {
    bench.board.replies["I,d,13,1"] = "~I,d,6{WRONG_MODE}";
    EXPECT_EQ(hold()["status"], "error");
    EXPECT_EQ(renew()["reason"], "not-held");
    bench.pass(10s);
    EXPECT_THAT(executed(), Not(Contains("I,d,13,0")));
}

TEST_F(HoldTest, StillWaitingAtItsEnd_IsNeverSent) {
    bench.board.mute = true;
    for (int i = 0; i < 30; ++i)
        bench.hear("asip/uno1/servo/in", R"({"write":[0,1],"reply_to":"me"})");
    bench.hear(kIo, R"({"write":[13,1],"hold_ms":100,"id":"late","reply_to":"me"})");
    bench.pass(200ms);
    bench.board.mute = false;
    bench.pass(10s);
    EXPECT_THAT(executed(), Not(Contains(HasSubstr("I,d,13,1"))));
    bool answered = false;
    for (const auto& text : bench.on("me")) {
        const auto answer = json::parse(text);
        if (answer.value("id", "") != "late") continue;
        answered = true;
        EXPECT_EQ(answer["reason"], "deadline");
    }
    EXPECT_TRUE(answered);
}

TEST_F(HoldTest, WhatCannotBeUndone_IsRefused) {
    const auto servo = hear({{"write", {0, 90}}, {"hold_ms", 500}}, "me", "asip/uno1/servo/in");
    EXPECT_EQ(servo["reason"], "invalid");
    EXPECT_THAT(servo["error"].get<std::string>(), HasSubstr("nothing undoes this command"));
    const auto raw = hear({{"raw", "I,d,13,1"}, {"hold_ms", 500}}, "me", "asip/uno1/in");
    EXPECT_EQ(raw["reason"], "invalid");
    EXPECT_THAT(executed(), IsEmpty());
}

TEST_F(HoldTest, TimeOutOfRange_IsRefused) {
    for (const json& time : {json(49), json(60001), json(-1), json(1.5), json("500"), json()}) {
        const auto answer = hear({{"write", {13, 1}}, {"hold_ms", time}});
        EXPECT_EQ(answer["reason"], "invalid") << time;
    }
    EXPECT_THAT(executed(), IsEmpty());
}

TEST_F(HoldTest, RenewalOfAnythingElse_IsRefused) {
    for (const json& which : {json(), json(false), json::array(), json("nothing"), json(7)})
        EXPECT_EQ(renew(which)["status"], "refused") << which;
}

TEST_F(HoldTest, TooManyHeld_IsRefusedAndTheNextWorks) {
    for (int pin = 0; pin < 64; ++pin)
        EXPECT_EQ(hold(pin, "me", std::to_string(pin))["status"], "ok") << pin;
    EXPECT_EQ(hold(64, "me", "64")["reason"], "invalid");
    EXPECT_EQ(hold(5, "me", "again")["status"], "ok") << "in the place of the one before";
    bench.pass(1s);
    EXPECT_EQ(hold(64, "me", "65")["status"], "ok");
}

TEST_F(HoldTest, AgentEnds_IsUndoneFirst) {
    hold();
    bench.release_holds();
    EXPECT_THAT(executed(), ElementsAre("I,d,13,1", "I,d,13,0"));
    EXPECT_TRUE(bench.bridge.is_safe());
}

TEST_F(HoldTest, Statistics_CountThem) {
    hold(12, "me", "1");
    hold(13, "me", "2");
    bench.publish_statistics();
    EXPECT_EQ(json::parse(bench.on("asip/servicebus/uno1/$stats").back())["holds"],
              json::parse(R"({"active":2,"expired":0})"));
    bench.pass(1s);
    bench.publish_statistics();
    EXPECT_EQ(json::parse(bench.on("asip/servicebus/uno1/$stats").back())["holds"],
              json::parse(R"({"active":0,"expired":2})"));
}

// --- the table alone: orders that a scripted board does not produce

Holds::Hold pin13(session::RequestId request, Time ends = Time{} + 500ms) {
    return {1, "h", "io", "I,d,13,1", "I,d,13,0", 500ms, ends, request};
}
session::Finished finished(session::RequestId id, session::Ending ending) {
    session::Finished end;
    end.id = id;
    end.ending = ending;
    return end;
}

TEST(Holds, PlainCommandExecutedBeforeTheHeldOne_DoesNotEndTheHold) {
    Holds holds;
    holds.begin(pin13(7));
    holds.on_finished(finished(8, session::Ending::kExecuted), "I,d,13,0");
    EXPECT_TRUE(holds.holds("I,d,13,0")) << "7 is still on its way";
    holds.on_finished(finished(7, session::Ending::kExecuted), "I,d,13,0");
    EXPECT_EQ(holds.take_expired(Time{} + 500ms).size(), 1u);
}

TEST(Holds, CommandInDoubt_IsUndone) {
    for (const auto ending : {session::Ending::kDoubt, session::Ending::kTimeout}) {
        Holds holds;
        holds.begin(pin13(7));
        holds.on_finished(finished(7, ending), "I,d,13,0");
        EXPECT_EQ(holds.take_expired(Time{} + 500ms).size(), 1u);
    }
}

TEST(Holds, SecondOneNotSent_TheFirstIsStillUndone) {
    Holds holds;
    holds.begin(pin13(7));
    holds.on_finished(finished(7, session::Ending::kExecuted), "I,d,13,0");
    holds.begin(pin13(8));
    holds.on_finished(finished(8, session::Ending::kNotSent), "I,d,13,0");
    EXPECT_EQ(holds.take_expired(Time{} + 500ms).size(), 1u);
}

}  // namespace
}  // namespace asip::agent
