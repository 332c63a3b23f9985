// SPDX-License-Identifier: Apache-2.0
#include "registry/history/kept_time.hpp"

#include <gtest/gtest.h>

#include "history_files.hpp"

namespace asip::registry {
namespace kept_time_test {

using namespace std::chrono_literals;

constexpr auto kYear = std::chrono::milliseconds(365 * 24h);
constexpr std::int64_t kToday = 1'800'000'000'000;

/// A machine with a clock that can be set.
struct Machine {
    std::string boot = "first";
    Duration up = 1h;
    std::chrono::milliseconds ahead{};  // of the time of day
    std::chrono::milliseconds passed{};

    Instant now() const { return {Time{} + up, wall(kToday) + passed + ahead}; }
    void run(KeptTime& kept, Duration time) {
        for (Duration step = 1min; time > 0s; time -= step) {
            up += step;
            passed += std::chrono::duration_cast<std::chrono::milliseconds>(step);
            kept.tick(now());
        }
    }
    void off(std::chrono::milliseconds time) {
        boot += "-again";
        up = 1min;
        passed += time;
    }
};

TEST(KeptTime, ClockIsSetWhileItRuns_OnlyWhatPassedCounts) {
    for (const auto set :
         {kYear, -kYear, std::chrono::milliseconds(10min), std::chrono::milliseconds(-10min)}) {
        Machine machine;
        KeptTime kept(machine.boot, machine.now());
        const auto begin = kept.at(machine.now().time);
        machine.run(kept, 10min);
        machine.ahead = set;
        machine.run(kept, 10min);
        machine.ahead = {};
        machine.run(kept, 48h);
        EXPECT_EQ(kept.at(machine.now().time) - begin, 48h + 20min);
    }
}

TEST(KeptTime, RegistryStartsAgain_TimeWithoutItCountsWhateverTheClockSays) {
    for (const auto set : {std::chrono::milliseconds(0), kYear, -kYear}) {
        Machine machine;
        KeptTime before(machine.boot, machine.now());
        machine.run(before, 10min);
        const auto mark = before.mark(machine.now());
        machine.ahead = set;
        machine.up += 3h;
        machine.passed += 3h;
        KeptTime after(machine.boot, machine.now());
        machine.run(after, 2min);  // the file could not be read earlier
        after.load(mark, machine.now());
        EXPECT_EQ(after.at(machine.now().time) - mark.kept, 3h + 2min);
        machine.run(after, 1min);
        EXPECT_EQ(after.at(machine.now().time) - mark.kept, 3h + 3min);
    }
}

TEST(KeptTime, MachineWasOffBetweenTwoDaysOfAClockThatWasNotSet_ThatTimeCounts) {
    Machine machine;
    KeptTime before(machine.boot, machine.now());
    machine.run(before, 25h);
    const auto mark = before.mark(machine.now());
    machine.off(240h);
    KeptTime after(machine.boot, machine.now());
    after.load(mark, machine.now());
    machine.run(after, 23h);
    EXPECT_EQ(after.at(machine.now().time) - mark.kept, 23h) << "not sure yet";
    machine.run(after, 2h);
    EXPECT_EQ(after.at(machine.now().time) - mark.kept, 265h);
}

TEST(KeptTime, MachineWasOffAndItsClockIsWrongForAWhile_OnlyTheTrueTimeCounts) {
    for (const auto wrong : {kYear, -kYear, -std::chrono::milliseconds(240h)}) {
        Machine machine;
        KeptTime before(machine.boot, machine.now());
        machine.run(before, 25h);
        const auto mark = before.mark(machine.now());
        machine.off(240h);
        machine.ahead = wrong;  // no battery
        KeptTime after(machine.boot, machine.now());
        after.load(mark, machine.now());
        machine.run(after, 5h);
        machine.ahead = {};
        machine.run(after, 25h);
        EXPECT_EQ(after.at(machine.now().time) - mark.kept, 270h);
    }
}

TEST(KeptTime, ClockWasWrongBeforeTheMachineWasOff_ThatTimeDoesNotCount) {
    Machine machine;
    machine.ahead = -kYear;
    KeptTime before(machine.boot, machine.now());
    machine.run(before, 5h);
    const auto mark = before.mark(machine.now());
    machine.off(1h);
    machine.ahead = {};
    KeptTime after(machine.boot, machine.now());
    after.load(mark, machine.now());
    machine.run(after, 48h);
    EXPECT_EQ(after.at(machine.now().time) - mark.kept, 48h);
}

TEST(KeptTime, MarksThatCannotBe_NeitherGoBackNorOverflow) {
    Machine machine;
    for (const auto kept : {INT64_MIN, std::int64_t{-5}, INT64_MAX}) {
        KeptTime time(machine.boot, machine.now());
        time.load(KeptTime::Mark{std::chrono::milliseconds(kept), wall(0), true, machine.boot, 1ms},
                  machine.now());
        const auto first = time.at(machine.now().time);
        machine.run(time, 25h);
        EXPECT_GT(time.at(machine.now().time), first);
        EXPECT_GT(first.count(), 0);
    }
}

}  // namespace kept_time_test
}  // namespace asip::registry
