// SPDX-License-Identifier: Apache-2.0
#include "agent/inbound/delayed_delivery.hpp"

#include <gtest/gtest.h>

namespace asip::agent {
namespace {

using namespace std::chrono_literals;

constexpr Time kOutset{1h};
constexpr Duration kSoon = 2ms;

struct DelayedDeliveryTest : testing::Test {
    void command(unsigned count = 1) {
        for (unsigned i = 0; i < count; ++i)
            way.commanded(now, true);
    }
    /// Sends the next check when it is due; its answer takes `took`.
    void check(Duration took = kSoon) {
        now = std::max(now, way.next_check().value());
        way.sent(now);
        now += took;
        way.answered(now);
    }
    void check_often(int times, Duration took = kSoon) {
        for (int i = 0; i < times; ++i)
            check(took);
    }
    /// Seconds before now that a message may be old.
    Duration age() const { return now - way.arrival(now); }

    DelayedDelivery way;
    Time now = kOutset;
};

TEST_F(DelayedDeliveryTest, NobodyCommands_NoChecks) {
    EXPECT_FALSE(way.next_check());
    EXPECT_EQ(age(), 0s);
}

TEST_F(DelayedDeliveryTest, Commanded_ChecksAtOnceAndEachSecondForAMinute) {
    EXPECT_TRUE(way.commanded(now, true));
    EXPECT_EQ(way.next_check(), now);
    check();
    EXPECT_EQ(way.next_check(), kOutset + 1s);
    EXPECT_FALSE(way.commanded(now, true)) << "they go on already";
    int checks = 1;
    for (; way.next_check(); ++checks)
        check();
    EXPECT_EQ(checks, 61);
    now = kOutset + 2h;
    EXPECT_EQ(age(), 0s);
    EXPECT_TRUE(way.commanded(now, true));
    EXPECT_EQ(way.next_check(), now);
}

TEST_F(DelayedDeliveryTest, OneAtATime) {
    command();
    way.sent(now);
    EXPECT_FALSE(way.next_check());
    now += 5s;
    EXPECT_FALSE(way.next_check());
}

TEST_F(DelayedDeliveryTest, AnsweredInTime_CommandsAreNew) {
    command();
    for (int i = 0; i < 20; ++i) {
        check(i % 2 == 0 ? 500ms : 1ms);
        EXPECT_EQ(age(), 0s);
        now += 499ms;
        EXPECT_EQ(age(), 0s);
    }
}

TEST_F(DelayedDeliveryTest, NoAnswerInTime_CommandsMayHaveComeSinceTheLastGoodCheck) {
    command();
    check_often(2);
    now = way.next_check().value();
    way.sent(now);
    now += 501ms;
    EXPECT_EQ(way.arrival(now), kOutset + 1s);
    now += 6s;
    EXPECT_EQ(way.arrival(now), kOutset + 1s);
}

TEST_F(DelayedDeliveryTest, LateAnswer_CommandsAreOldUntilACheckBehindItIsInTime) {
    command();
    check_often(2);
    check(7s);
    EXPECT_EQ(way.arrival(now), kOutset + 1s);
    EXPECT_EQ(way.next_check(), now + DelayedDelivery::kCatchingUp);
    now = way.next_check().value();
    way.sent(now);
    now += 1ms;
    EXPECT_EQ(way.arrival(now), kOutset + 1s) << "not answered yet";
    way.answered(now);
    EXPECT_EQ(age(), 0s);
}

TEST_F(DelayedDeliveryTest, LateAgain_IsStillAsOld) {
    command();
    check_often(2);
    check(7s);
    check(7s);
    EXPECT_EQ(way.arrival(now), kOutset + 1s);
    check();
    EXPECT_EQ(age(), 0s);
}

TEST_F(DelayedDeliveryTest, CheckSentLate_IsNoProofOfTheTimeBefore) {
    command();
    check();
    now = way.next_check().value() + 3s;
    EXPECT_EQ(way.arrival(now), kOutset);
    way.sent(now);
    now += kSoon;
    way.answered(now);
    EXPECT_EQ(way.arrival(now), kOutset);
    check();
    EXPECT_EQ(age(), 0s);
}

TEST_F(DelayedDeliveryTest, StalledWhenTheMinuteIsOver_IsSeenToItsEnd) {
    command();
    while (*way.next_check() < kOutset + 59s)
        check();
    const Time last_good = now - kSoon;
    check(30s - 1ms);
    EXPECT_EQ(way.arrival(now), last_good);
    command();
    EXPECT_EQ(way.arrival(now), last_good) << "not the first after a quiet minute";
    check();
    EXPECT_EQ(age(), 0s);
}

TEST_F(DelayedDeliveryTest, FirstCheckIsLate_CommandsAreNoOlderThanTheFirst) {
    command();
    way.sent(now);
    now += 8s;
    EXPECT_EQ(way.arrival(now), kOutset);
}

TEST_F(DelayedDeliveryTest, FullWindowBehindALateAnswer_MoreMayWaitAtTheBroker) {
    command();
    check_often(2);
    check(7s);
    for (int i = 0; i < 3; ++i) {
        now = way.next_check().value();
        way.sent(now);
        command(DelayedDelivery::kWindow);
        way.answered(now += kSoon);
        EXPECT_EQ(way.arrival(now), kOutset + 1s);
    }
    now = way.next_check().value();
    way.sent(now);
    command(DelayedDelivery::kWindow - 1);
    way.answered(now += kSoon);
    EXPECT_EQ(age(), 0s);
}

TEST_F(DelayedDeliveryTest, AlwaysAFullWindow_IsNewAgainAfterAWhile) {
    command();
    check(7s);
    const Time late = now;
    do {
        now = way.next_check().value();
        way.sent(now);
        command(5 * DelayedDelivery::kWindow);
        way.answered(now += kSoon);
    } while (age() > 0s && now < late + 1min);
    EXPECT_LE(now, late + DelayedDelivery::kDraining + 1s);
}

TEST_F(DelayedDeliveryTest, FullWindowsWithoutALateAnswer_AreNew) {
    command();
    way.sent(now);
    command(1000);
    way.answered(now += kSoon);
    EXPECT_EQ(age(), 0s);
}

TEST_F(DelayedDeliveryTest, SlowLink_FourTimesItsUsualAnswerIsLate) {
    command();
    check(600ms);
    EXPECT_GT(age(), 0s) << "nothing is usual yet";
    check_often(2, 600ms);
    check_often(20, 700ms);
    EXPECT_EQ(age(), 0s);
    check(2799ms);
    EXPECT_EQ(age(), 0s);
    check(2900ms);
    EXPECT_GT(age(), 0s);
}

TEST_F(DelayedDeliveryTest, OneStallAndOneQuickAnswer_DoNotChangeWhatIsUsual) {
    command();
    check(7s);
    check_often(2);
    now = way.next_check().value();
    way.sent(now);
    now += 501ms;
    EXPECT_GT(age(), 0s);
    way.answered(now);
    check_often(5, 700ms);
    check(1ms);
    now = way.next_check().value();
    way.sent(now);
    now += 2s;
    EXPECT_EQ(age(), 0s);
}

TEST_F(DelayedDeliveryTest, BrokerThatNeverAnswersChecks_IsBelievedAfterAWhile) {
    command();
    way.sent(now);
    now += DelayedDelivery::kNoAnswer - 1s;
    EXPECT_GT(age(), 0s);
    now += 1s;
    EXPECT_EQ(age(), 0s);
    EXPECT_FALSE(way.next_check());
    way.answered(now);
    EXPECT_GT(age(), 0s) << "so it was a stall";
}

TEST_F(DelayedDeliveryTest, AgentHeldUp_CommandsMayHaveComeSinceThenUntilACheckIsAnswered) {
    command();
    check_often(2);
    const Time stopped = now;
    now += 600ms;
    way.process_paused(now, stopped);
    EXPECT_EQ(way.next_check(), now);
    EXPECT_EQ(way.arrival(now), stopped);
    way.sent(now);
    now += 400ms;
    EXPECT_EQ(way.arrival(now), stopped) << "however long it takes to read them";
    way.answered(now);
    EXPECT_EQ(age(), 0s);
}

TEST_F(DelayedDeliveryTest, AgentHeldUpWhileACheckHasNoAnswer_TheNextOneCounts) {
    command();
    check_often(2);
    now = way.next_check().value();
    way.sent(now);
    const Time stopped = now;
    now += 40s;
    way.process_paused(now, stopped);
    EXPECT_FALSE(way.next_check());
    EXPECT_EQ(way.arrival(now), stopped);
    EXPECT_FALSE(way.answered(now));
    EXPECT_EQ(way.arrival(now), stopped) << "that answer has waited, too";
    check();
    EXPECT_EQ(age(), 0s);
}

TEST_F(DelayedDeliveryTest, AgentHeldUpThatNobodyCommands_ChecksOnce) {
    const Time stopped = now;
    now += 5s;
    way.process_paused(now, stopped);
    command();
    EXPECT_EQ(way.arrival(now), stopped);
    now += 70s;
    way.process_paused(now, now - 1s);
    check();
    EXPECT_EQ(age(), 0s);
    EXPECT_FALSE(way.next_check());
}

TEST_F(DelayedDeliveryTest, AgentHeldUpBehindAStall_CommandsAreAsOldAsBefore) {
    command();
    check_often(2);
    check(7s);
    const Time stopped = now;
    now += 600ms;
    way.process_paused(now, stopped);
    EXPECT_EQ(way.arrival(now), kOutset + 1s);
    check();
    EXPECT_EQ(age(), 0s);
}

TEST_F(DelayedDeliveryTest, AgentHeldUpAgainAndAgain_IsAsOldAsTheFirst) {
    command();
    check_often(2);
    const Time stopped = now;
    for (int i = 0; i < 5; ++i) {
        way.process_paused(now + 600ms, now);
        now += 600ms;
        EXPECT_EQ(way.arrival(now), stopped);
        if (way.next_check()) way.sent(now);
    }
    way.answered(now);
    check();
    EXPECT_EQ(age(), 0s);
}

TEST_F(DelayedDeliveryTest, AgentHeldUpAtABrokerThatNeverAnswers_IsBelievedAfterAWhile) {
    way.process_paused(now, now - 1s);
    way.sent(now);
    now += DelayedDelivery::kNoAnswer;
    EXPECT_EQ(age(), 0s);
}

TEST_F(DelayedDeliveryTest, AnswerToNothing_IsIgnored) {
    way.answered(now);
    command();
    way.answered(now);
    EXPECT_EQ(way.next_check(), now);
}

}  // namespace
}  // namespace asip::agent
