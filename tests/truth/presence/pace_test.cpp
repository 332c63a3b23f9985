// SPDX-License-Identifier: Apache-2.0
// How a truth test with real programs tells a wrong answer from a starved machine.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <thread>

#include "tests/truth/presence/machine.hpp"

namespace truth {
namespace {

using namespace std::chrono_literals;
using asip::Clock;
using asip::Duration;
using asip::Time;

constexpr Time kBegin = Time{} + 1000s;

/// Wake-ups from a time on, each `slower` times as slow as on a quiet machine; the time behind them.
Time wake(Pace& pace, Time from, Duration time, double slower) {
    const Time until = from + time;
    while (from < until) {
        const Time due = from + Pace::kSleep;
        from = due + std::chrono::duration_cast<Duration>((Pace::kWork + Pace::kLateness) * slower);
        pace.woke(due, from);
    }
    return from;
}

TEST(Pace, QuietMachine_WrongAnswerIsWrong) {
    Pace pace(kBegin);
    const Time now = wake(pace, kBegin, 60s, 1);
    EXPECT_FALSE(pace.starved(kBegin, now));
    EXPECT_EQ(pace.passed(now - 10s, now - 5s), 5s);
    EXPECT_FALSE(pace.had_time(now - 6900ms, 1s, now));
    EXPECT_TRUE(pace.had_time(now - 7s, 1s, now));
}

TEST(Pace, FullMachine_StarvesAndWaitsAsManyTimesLonger) {
    Pace pace(kBegin);
    const Time now = wake(pace, kBegin, 100s, 4);
    EXPECT_TRUE(pace.starved(now - 4s, now));
    EXPECT_NEAR(std::chrono::duration<double>(pace.passed(kBegin, now)).count(), 25, .1);
    EXPECT_FALSE(pace.had_time(now - 27s, 1s, now));
    EXPECT_TRUE(pace.had_time(now - 29s, 1s, now)) << "a wait has an end";
}

TEST(Pace, LittleSlower_IsNotStarved) {
    Pace pace(kBegin);
    const Time now = wake(pace, kBegin, 60s, 1.1);
    EXPECT_FALSE(pace.starved(now - 4s, now));
}

TEST(Pace, StoppedOnce_OnlyTimesWithTheStopAreStarved) {
    Pace pace(kBegin);
    const Time before = wake(pace, kBegin, 10s, 1);
    const Time due = before + Pace::kSleep;
    const Time back = due + 2s;
    pace.woke(due, back);
    const Time now = wake(pace, back, 10s, 1);
    EXPECT_TRUE(pace.starved(before - 4s, back));
    EXPECT_TRUE(pace.starved(back - 1s, now));
    EXPECT_FALSE(pace.starved(before - 5s, before));
    EXPECT_FALSE(pace.starved(back, now));
}

TEST(Pace, NoWakeUpYet_IsStarved) {
    Pace pace(kBegin);
    const Time last = wake(pace, kBegin, 10s, 1);
    EXPECT_FALSE(pace.starved(last - 4s, last + 400ms));
    EXPECT_TRUE(pace.starved(last - 4s, last + 1s));
    EXPECT_FALSE(pace.had_time(last, 1s, last + 1h));
}

/// A process that is stopped for two seconds. How it says what it knew before, no load can change.
TEST(Machine, StoppedProcess_SaysThatItWasStarved) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        const Machine machine;
        const Time before = Clock::now();
        raise(SIGSTOP);
        const Time back = Clock::now();
        _exit(back - before >= 2s && machine.pace().starved(before, back) ? 0 : 1);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, WUNTRACED), child);
    ASSERT_TRUE(WIFSTOPPED(status));
    std::this_thread::sleep_for(2s);
    kill(child, SIGCONT);
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

}  // namespace
}  // namespace truth
