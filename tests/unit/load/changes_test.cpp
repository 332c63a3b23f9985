// SPDX-License-Identifier: Apache-2.0
#include "bench/load/changes.hpp"

#include <gtest/gtest.h>

namespace asip::load {
namespace {

using namespace std::chrono_literals;
using Kind = bus::ChangeEvent::Kind;

std::string event(std::uint64_t seq, Kind kind = Kind::kState, const std::string& registry = "r1",
                  const std::string& epoch = "e-1") {
    bus::ChangeEvent event;
    event.kind = kind;
    event.registry = registry;
    event.epoch = epoch;
    event.seq = seq;
    if (kind != Kind::kReset) {
        event.board.board = "load-000001";
        event.board.state = "online";
    }
    return bus::encode(event);
}

struct ChangesTest : testing::Test {
    SeenChanges seen(const std::string& registry = "r1") const { return changes.seen().at(registry); }

    Time start = Time{} + 1h;
    Changes changes{3, [this](const bus::ChangeEvent& one) {
                        return one.kind == Kind::kState ? std::optional(start) : std::nullopt;
                    }};
};

TEST_F(ChangesTest, OneEventForAll_IsTimedForTheFirstAndTheLast) {
    changes.take(0, event(1), start + 10ms);
    changes.take(1, event(1), start + 20ms);
    changes.take(2, event(1), start + 80ms);
    EXPECT_EQ(seen().events, 3u);
    EXPECT_EQ(seen().different, 1u);
    EXPECT_EQ(seen().first.count(), 1u);
    EXPECT_NEAR(seen().first.longest_seconds(), .01, 1e-9);
    EXPECT_EQ(seen().last.count(), 1u);
    EXPECT_NEAR(seen().last.longest_seconds(), .08, 1e-9);
}

TEST_F(ChangesTest, ChangeThatIsNotOurs_HasNoTimes) {
    changes.take(0, event(1, Kind::kDescription), start);
    EXPECT_EQ(seen().events, 1u);
    EXPECT_EQ(seen().first.count() + seen().last.count(), 0u);
}

TEST_F(ChangesTest, NumbersLeftOut_AreCountedForEachWatcherThatMissedThem) {
    changes.take(0, event(1), start);
    changes.take(1, event(1), start);
    changes.take(2, event(5), start);
    changes.take(0, event(4), start);
    changes.take(1, event(2), start);
    EXPECT_EQ(seen().gaps, 1u);
    EXPECT_EQ(seen().left_out, 2u) << "2 and 3 by the first; the third watcher begins with 5";
    EXPECT_EQ(seen().resets, 0u);
}

TEST_F(ChangesTest, Resets_CountWithinAnEpoch) {
    changes.take(0, event(1, Kind::kReset), start);
    changes.take(0, event(2), start);
    EXPECT_EQ(seen().resets, 0u) << "each connection of a registry begins with one";
    changes.take(0, event(9, Kind::kReset), start);
    EXPECT_EQ(seen().resets, 1u);
    EXPECT_EQ(seen().left_out, 0u);
    changes.take(0, event(1, Kind::kReset, "r1", "e-2"), start);
    changes.take(0, event(2, Kind::kState, "r1", "e-2"), start);
    EXPECT_EQ(seen().resets, 1u);
    EXPECT_EQ(seen().left_out, 0u);
}

TEST_F(ChangesTest, WatcherThatWasAway_BeginsAnew) {
    changes.take(0, event(1), start);
    changes.take(1, event(1), start);
    changes.forget(0);
    changes.take(0, event(7), start);
    EXPECT_EQ(seen().left_out, 0u);
    changes.take(1, event(7), start);
    EXPECT_EQ(seen().left_out, 5u);
}

TEST_F(ChangesTest, Registries_AreCountedApart) {
    changes.take(0, event(1), start);
    changes.take(0, event(8, Kind::kState, "r2"), start);
    changes.take(0, event(2), start);
    EXPECT_EQ(seen("r1").events, 2u);
    EXPECT_EQ(seen("r2").events, 1u);
    EXPECT_EQ(seen("r1").left_out, 0u);
}

TEST_F(ChangesTest, AfterAMinute_AnEventIsForgottenWithItsTimes) {
    changes.take(0, event(1), start + 1s);
    changes.take(1, event(1), start + 2s);
    changes.take(0, event(2), start + 1s + Changes::kKept + 1ms);
    EXPECT_EQ(seen().last.count(), 2u);
    changes.take(2, event(1), start + 2min);
    EXPECT_EQ(seen().very_late, 1u);
    EXPECT_EQ(seen().different, 2u) << "it is no new change";
    EXPECT_EQ(seen().first.count(), 2u);
    EXPECT_EQ(seen().events, 4u);
}

TEST_F(ChangesTest, AnyPayload_DoesNoHarm) {
    for (const char* text : {"", "{}", "[1]", "{\"event\":\"state\",\"seq\":-1}", "\xff"})
        changes.take(0, text, start);
    for (std::size_t i = 0; i < 2 * Changes::kMaxRegistries; ++i)
        changes.take(0, event(1, Kind::kState, "x" + std::to_string(i)), start);
    EXPECT_LE(changes.seen().size(), Changes::kMaxRegistries);
}

TEST_F(ChangesTest, MoreThanAreKept_DropTheOldest) {
    Changes few(2, [this](const bus::ChangeEvent&) { return std::optional(start); }, 50);
    for (std::uint64_t seq = 1; seq <= 60; ++seq)
        few.take(0, event(seq), start);
    few.take(1, event(1), start);
    EXPECT_EQ(few.seen().at("r1").very_late, 1u);
    few.take(1, event(60), start);
    EXPECT_EQ(few.seen().at("r1").very_late, 1u);
    EXPECT_EQ(few.seen().at("r1").first.count(), 60u);
    EXPECT_EQ(few.seen().at("r1").last.count(), 60u);
}

}  // namespace
}  // namespace asip::load
