// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "monitor.hpp"

namespace asip::sim {
namespace {

using namespace std::chrono_literals;
using namespace std::string_literals;

double idle_share(Monitor& monitor, SimTime time) {
    const auto cycles = monitor->cycles(), idle = monitor->idle();
    monitor->run_for(time);
    return static_cast<double>(monitor->idle() - idle) / static_cast<double>(monitor->cycles() - cycles);
}

TEST(IdleLoop, FirmwareThatWaits_IsNotSimulatedRoundForRound) {
    Monitor monitor;
    EXPECT_GE(idle_share(monitor, 100ms), 0.95);
    EXPECT_EQ(monitor.ask("Ex", 1), "x");
}

TEST(IdleLoop, StackIsWatched_EachInstructionIsSimulated) {
    Monitor monitor;
    monitor->watch_stack();
    EXPECT_EQ(idle_share(monitor, 10ms), 0);
}

TEST(IdleLoop, RoundsThatChangeAPin_AreAllSimulated) {
    Monitor monitor;
    int edges = 0;
    monitor->on_pin(13, [&](Level) { ++edges; });
    monitor.send("O");
    EXPECT_EQ(idle_share(monitor, 10ms), 0);
    EXPECT_GE(edges, 10'000) << "about ten cycles a round";
    monitor.send("x");
    EXPECT_GE(idle_share(monitor, 100ms), 0.9) << "it waits again";
}

TEST(IdleLoop, RoundsThatReadATimer_AreAllSimulated) {
    Monitor monitor;
    std::vector<Cycles> edges;
    monitor->on_pin(9, [&](Level) { edges.push_back(monitor->cycles()); });
    const std::string pulse_of_30_ms{'S', '\x30', '\x75'};
    monitor.send(pulse_of_30_ms);
    monitor->run_for(35ms);
    ASSERT_EQ(edges.size(), 2u);
    EXPECT_NEAR(static_cast<double>(edges[1] - edges[0]), 480'000, 100);
}

TEST(IdleLoop, WatchdogWhileTheFirmwareWaits_ComesInItsTime) {
    Monitor monitor;
    monitor.send("X");
    const auto began = monitor->now();
    ASSERT_TRUE(monitor->run_until([&] { return monitor->resets() == 1; }, 1s));
    EXPECT_GE(monitor->now() - began, 12ms);
    EXPECT_LE(monitor->now() - began, 18ms);
}

/// What a sketch that waits, measures, counts edges and sends does, with the cycle of each byte.
std::vector<ReceivedByte> session(bool each_instruction) {
    Monitor monitor({{"square-wave", {{"pin", 2}, {"hertz", 777}}, "wave"}});
    if (each_instruction) monitor->watch_stack();
    for (const std::string& command :
         {"I"s, "E!"s, "T\x05"s, "A\x01"s, "S\xe8\x03"s, "K\x03"s, "i"s, "O"s, "x"s, "i"s}) {
        monitor->send(command);
        monitor->run_for(23'457us);
    }
    return monitor->take_bytes();
}

TEST(IdleLoop, Answers_AreThoseOfEachInstructionSimulated) {
    const auto passed = session(false), simulated = session(true);
    ASSERT_EQ(passed.size(), simulated.size());
    EXPECT_GE(passed.size(), 10u);
    for (std::size_t i = 0; i < passed.size(); ++i) {
        EXPECT_EQ(passed[i].byte, simulated[i].byte) << "byte " << i;
        // simavr looks at a timer that was set between two others a few instructions late.
        EXPECT_NEAR(static_cast<double>(passed[i].cycle), static_cast<double>(simulated[i].cycle), 100)
            << "byte " << i;
    }
}

}  // namespace
}  // namespace asip::sim
