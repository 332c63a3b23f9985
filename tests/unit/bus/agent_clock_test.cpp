// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/agent_clock.hpp"

#include <gtest/gtest.h>

#include <random>

namespace asip::bus {
namespace {

using namespace std::chrono_literals;

Random drawing(std::uint64_t seed) {
    return [engine = std::make_shared<std::mt19937_64>(seed)] { return (*engine)(); };
}

Time at(Duration since_start) {
    return Time(since_start);
}

TEST(AgentClock, ItsReading_IsUnderstoodByItAlone) {
    const AgentClock clock(drawing(1)), after_restart(drawing(2));
    const auto reading = clock.read(at(123'456'789us));
    EXPECT_TRUE(reading.ends_with("-123456")) << reading;
    EXPECT_EQ(clock.time_of(reading), at(123'457ms)) << "up to a millisecond later, never earlier";
    EXPECT_FALSE(after_restart.time_of(reading));
}

TEST(AgentClock, NoReading_IsNoTime) {
    const AgentClock clock([] { return std::uint64_t{0}; });
    EXPECT_TRUE(clock.time_of("00000000-1"));
    for (const char* text : {"", "00000000", "00000000-", "00000000-x", "00000000--1", "00000000-1x",
                             "00000000-4000000000001", "00000000-99999999999999999999", "0000000-1", "\xff"})
        EXPECT_FALSE(clock.time_of(text)) << text;
}

/// Two machines: that of the agent is `ahead` of the other one, which asks.
struct Machines : testing::Test {
    std::string answer_at(Time here) { return clock.read(here + ahead); }
    /// A question that was asked `before` the agent answered it, and `after` that the answer arrived.
    void ask(Duration before, Duration after) {
        now += before;
        const auto reading = answer_at(now);
        now += after;
        clocks.note("uno1", reading, now - before - after, now);
    }
    /// By how much what is believed of the agent's clock is ahead of what it shows.
    Duration error() {
        const auto believed = clock.time_of(clocks.reading("uno1", now));
        return believed ? *believed - (now + ahead) : Duration::max();
    }
    AgentClock clock{drawing(1)};
    AgentClocks clocks;
    Duration ahead = 1000s;
    Time now = at(5000s);
};

TEST_F(Machines, NothingWasAnswered_ClockIsNotKnown) {
    EXPECT_EQ(clocks.reading("uno1", now), "");
    clocks.note("uno1", "nonsense", now, now);
    EXPECT_EQ(clocks.reading("uno1", now), "");
}

TEST_F(Machines, ManyAnswers_TheShortestWayCounts) {
    ask(4s, 1s);
    EXPECT_GE(error(), 4s);
    EXPECT_LE(error(), 4s + 3ms);
    ask(2ms, 4s);
    for (int i = 0; i < 10; ++i)
        ask(1s, 1s);
    EXPECT_GE(error(), 2ms);
    EXPECT_LE(error(), 5ms);
}

TEST_F(Machines, WhateverTheWayAndTheRestarts_ClockIsNeverBelievedToShowLess) {
    std::mt19937 random(7);
    const auto up_to = [&](int ms) { return std::chrono::microseconds(random() % (1000u * ms) + 1); };
    for (int i = 0; i < 10'000; ++i) {
        if (random() % 100 == 0) {
            clock = AgentClock(drawing(random()));
            ahead = -4000s + up_to(8'000'000);
            EXPECT_EQ(error(), Duration::max());
        }
        ask(up_to(random() % 10 == 0 ? 8000 : 20), up_to(20));
        EXPECT_GE(error(), 0s);
        EXPECT_LE(error(), 8001ms);
    }
}

TEST_F(Machines, OneWasSuspended_IsNoticedWithTheNextAnswer) {
    ask(1ms, 1ms);
    ahead += 600s;  // we were
    ask(1ms, 1ms);
    EXPECT_GE(error(), 0s);
    EXPECT_LE(error(), 5ms);
    ahead -= 600s;  // the agent was
    ask(1ms, 1ms);
    EXPECT_GE(error(), 0s);
    EXPECT_LE(error(), 5ms);
}

TEST_F(Machines, MoreThanAreRemembered_AreLearnedAnew) {
    for (std::size_t i = 0; i < AgentClocks::kMax; ++i)
        clocks.note("board" + std::to_string(i), answer_at(now), now, now);
    EXPECT_NE(clocks.reading("board0", now), "");
    clocks.note("one more", answer_at(now), now, now);
    EXPECT_EQ(clocks.reading("board0", now), "");
    EXPECT_NE(clocks.reading("one more", now), "");
}

}  // namespace
}  // namespace asip::bus
