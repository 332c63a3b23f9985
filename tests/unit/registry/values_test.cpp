// SPDX-License-Identifier: Apache-2.0
// Values that are kept, in simulated time: the recorder, and the file that it is written to.
#include <gtest/gtest.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "history_files.hpp"
#include "registry/values/recorder.hpp"
#include "registry/values/value_blocks.hpp"
#include "registry/values/value_file.hpp"
#include "registry/values/value_keeper.hpp"

namespace asip::registry {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

const PropertyKey kTemperature{"desk", "temperature"};
constexpr std::int64_t kMonday = 1'700'006'400'000;  // a whole hour

/// The machine on which a registry runs: its clocks, its recorder, and the file that is on its disk.
class Machine {
  public:
    Machine() { start(); }

    Instant now() const { return {Time(monotonic), wall(wall_clock)}; }
    void start() {
        file = std::make_unique<ValueFile>(options());
        recorder = std::make_unique<Recorder>(memory);
        recorder->begin(file->last(), now());
    }
    /// Nothing is written any more, and the machine is off for a while.
    void cut_power(milliseconds off) {
        recorder.reset();
        file.reset();
        wall_clock += off.count();
        monotonic = seconds(5);
        start();
    }
    void pass(milliseconds time) {
        monotonic += time;
        wall_clock += time.count();
    }
    void set(double value, const PropertyKey& key = kTemperature) { recorder->set(key, value, now()); }
    /// It has this value for so long.
    void hold(double value, milliseconds time) {
        set(value);
        pass(time);
    }
    void write() { EXPECT_TRUE(file->write(recorder->take(now()))); }
    void write_after(milliseconds time) {
        pass(time);
        write();
    }
    /// What is kept from then until now.
    bus::Answer ask(milliseconds since, std::size_t points) {
        bus::Query query;
        query.find = bus::Find::kValues;
        query.board = kTemperature.board;
        query.property = kTemperature.property;
        query.to = wall(wall_clock);
        query.from = query.to - since;
        query.limit = points;
        return file->find(query, recorder->present(now()));
    }
    ValueFile::Options options() const {
        ValueFile::Options result;
        result.path = disk.path();
        result.max_bytes = max_bytes;
        result.max_age = max_age;
        return result;
    }

    HistoryFile disk;
    std::size_t max_bytes = std::size_t{1} << 30;
    std::array<Tick, kLevels> max_age = ValueFile::Options{}.max_age;
    Recorder::Options memory{};
    std::int64_t wall_clock = kMonday;
    Duration monotonic = seconds(100);
    std::unique_ptr<ValueFile> file;
    std::unique_ptr<Recorder> recorder;
};

/// What the value was at a time: of the point before. Nothing: a gap, or before all points.
std::optional<bus::ValuePoint> value_at(const bus::Answer& answer, std::int64_t time) {
    std::optional<bus::ValuePoint> result;
    for (const auto& point : answer.values) {
        if (point.at > wall(time)) break;
        result = point;
    }
    return result && result->known ? result : std::nullopt;
}

TEST(Values, FewChanges_EachIsAPoint) {
    Machine machine;
    machine.hold(20.5, seconds(90));
    machine.hold(21.25, seconds(90));
    machine.write();
    const auto answer = machine.ask(minutes(10), 100);
    EXPECT_EQ(answer.level, "changes");
    ASSERT_EQ(answer.values.size(), 2u);
    EXPECT_EQ(answer.values[0], (bus::ValuePoint{wall(kMonday), true, 20.5, 20.5, 20.5}));
    EXPECT_EQ(answer.values[1], (bus::ValuePoint{wall(kMonday + 90'000), true, 21.25, 21.25, 21.25}));
}

TEST(Values, SameValueAgain_IsNoPoint) {
    Machine machine;
    for (int i = 0; i < 100; ++i) {
        machine.hold(7, seconds(1));
    }
    machine.write();
    EXPECT_EQ(machine.ask(minutes(10), 100).values.size(), 1u);
}

TEST(Values, BoardGoneAndBack_GapBetween) {
    Machine machine;
    machine.hold(5, minutes(1));
    machine.hold(kGap, minutes(1));
    machine.hold(5, minutes(1));
    machine.write();
    for (const milliseconds since : {milliseconds(minutes(10)), milliseconds(hours(40))}) {
        const auto answer = machine.ask(since, 1000);
        EXPECT_TRUE(value_at(answer, kMonday + 30'000)) << answer.level;
        EXPECT_FALSE(value_at(answer, kMonday + 90'000)) << answer.level;
        EXPECT_TRUE(value_at(answer, kMonday + 150'000)) << answer.level;
    }
}

TEST(Values, Minute_HasMinMeanByTimeAndMax) {
    Machine machine;
    machine.hold(10, seconds(45));
    machine.hold(20, seconds(15));
    machine.hold(0, minutes(2));
    machine.write();
    const auto answer = machine.ask(hours(24 * 2), 1000);
    EXPECT_EQ(answer.level, "minutes");
    const auto first = value_at(answer, kMonday + 1000);
    ASSERT_TRUE(first);
    EXPECT_EQ(*first, (bus::ValuePoint{wall(kMonday), true, 12.5, 10, 20}));
    EXPECT_EQ(value_at(answer, kMonday + 60'000)->max, 0);
}

TEST(Values, SteadyForFiveDays_KnownAtEachLevel) {
    Machine machine;
    machine.set(42);
    for (int i = 0; i < 5 * 24; ++i) {
        machine.write_after(hours(1));
    }
    for (const auto& [since, level] : {std::pair(hours(1), "changes"), std::pair(hours(100), "minutes")}) {
        const auto answer = machine.ask(since, 1000);
        EXPECT_EQ(answer.level, level);
        ASSERT_EQ(answer.values.size(), 1u) << level;
        EXPECT_EQ(answer.values[0].mean, 42);
        EXPECT_EQ(answer.values[0].at, wall(machine.wall_clock) - since);
    }
    const auto hourly = machine.ask(hours(24 * 365), 365);
    EXPECT_EQ(hourly.level, "hours");
    EXPECT_EQ(hourly.values.front().mean, 42);
}

/// A day is a triangle: 0 at midnight, 43,200 / 100 at noon. A value each ten seconds; each five minutes they
/// are written.
TEST(Values, WeekWithTwoPowerCuts_EachHourIsThereButTheCuts) {
    Machine machine;
    const auto value = [&] {
        const auto second = (machine.wall_clock - kMonday) / 1000 % 86'400;
        return static_cast<double>(std::min(second, 86'400 - second)) / 100;
    };
    const std::int64_t first_cut = kMonday + 30 * 3'600'000,
                       second_cut = kMonday + 100 * 3'600'000 + 1'234'567;
    bool first = false, second = false;
    while (machine.wall_clock < kMonday + 7 * 86'400'000) {
        machine.hold(value(), seconds(10));
        if (machine.wall_clock % 300'000 == 0) machine.write();
        if (!first && machine.wall_clock >= first_cut) {
            first = true;
            machine.cut_power(hours(2));
        }
        if (!second && machine.wall_clock >= second_cut) {
            second = true;
            machine.cut_power(minutes(30));
        }
    }
    const auto week = machine.ask(hours(7 * 24), 1000);
    EXPECT_EQ(week.level, "minutes");
    EXPECT_LE(week.values.size(), 1000u);
    for (std::int64_t at = kMonday + 1'800'000; at < machine.wall_clock; at += 3'600'000) {
        const bool cut = (at > first_cut && at < first_cut + 7'200'000) ||
                         (at > second_cut && at < second_cut + 1'800'000);
        const auto point = value_at(week, at);
        ASSERT_EQ(point.has_value(), !cut) << (at - kMonday) / 60'000 << " minutes after the beginning";
        if (!point) continue;
        const auto s = static_cast<double>((at - kMonday) / 1000 % 86'400);
        const double middle = std::min(s, 86'400 - s) / 100;
        EXPECT_NEAR(point->mean, middle, 7) << (at - kMonday) / 60'000;
        EXPECT_LE(point->min, point->mean);
        EXPECT_GE(point->max, point->mean);
    }
}

TEST(Values, PowerCut_LosesOnlyWhatWasNotWritten) {
    Machine machine;
    machine.hold(1, seconds(10));
    machine.write();
    // never written
    machine.hold(2, seconds(9));
    machine.cut_power(minutes(5));
    machine.hold(3, seconds(10));
    machine.write();
    const auto answer = machine.ask(hours(1), 100);
    ASSERT_EQ(answer.values.size(), 3u);
    EXPECT_EQ(answer.values[0].mean, 1);
    EXPECT_EQ(answer.values[1], (bus::ValuePoint{wall(kMonday + 10'000), false, 0, 0, 0}));
    EXPECT_EQ(answer.values[2].mean, 3);
}

TEST(Values, ClockSetSoonAfterStart_CorrectsTheTimes) {
    Machine machine;
    machine.hold(1, minutes(5));
    machine.write();
    machine.wall_clock += 3 * 86'400'000;
    machine.write_after(minutes(1));
    const auto answer = machine.ask(hours(1), 100);
    ASSERT_EQ(answer.values.size(), 1u);
    EXPECT_EQ(answer.values[0].at, wall(kMonday + 3 * 86'400'000));
}

TEST(Values, ClockSetLater_BackAndForward_WhatWasKeptStays) {
    Machine machine;
    machine.hold(1, hours(2));
    machine.write();
    machine.wall_clock -= 3'600'000;  // this hour is there twice
    machine.hold(3, hours(2));
    machine.write();
    const auto twice = machine.ask(hours(3), 100);
    EXPECT_EQ(value_at(twice, kMonday + 1'800'000)->mean, 1);
    const auto both = value_at(twice, kMonday + 5'400'000);
    ASSERT_TRUE(both);
    EXPECT_EQ(both->min, 1);
    EXPECT_EQ(both->max, 3);
    EXPECT_EQ(value_at(twice, kMonday + 2 * 3'600'000 + 1'800'000)->mean, 3);

    machine.wall_clock += 400 * std::int64_t{86'400'000};  // by mistake: nothing is too old now
    machine.write();
    machine.write_after(hours(2));
    EXPECT_TRUE(value_at(machine.ask(hours(1), 100), machine.wall_clock - 60'000));
    machine.wall_clock -= 400 * std::int64_t{86'400'000};
    machine.write();
    machine.write_after(hours(1));
    EXPECT_EQ(value_at(machine.ask(hours(12), 1000), kMonday + 1'800'000)->mean, 1);
}

TEST(Values, StartWithAClockFromBefore_GoesOnBehindWhatIsKept) {
    Machine machine;
    machine.hold(1, hours(5));
    machine.write();
    machine.cut_power(-hours(4));  // no clock in the machine
    machine.hold(2, minutes(1));
    machine.write();
    machine.wall_clock += 5 * 3'600'000;  // now it is told the time
    machine.write_after(minutes(1));
    const auto answer = machine.ask(hours(12), 1000);
    EXPECT_EQ(value_at(answer, kMonday + 3'600'000)->mean, 1);
    EXPECT_EQ(value_at(answer, machine.wall_clock - 30'000)->mean, 2);
    EXPECT_FALSE(value_at(answer, kMonday + 5 * 3'600'000 + 1'800'000));
}

TEST(Values, MemoryFull_GapThenGoesOn_LostAreCounted) {
    Machine machine;
    machine.memory.max_waiting = 10;
    machine.start();
    for (int i = 1; i <= 30; ++i) {
        machine.hold(i, seconds(1));
    }
    EXPECT_EQ(machine.recorder->dropped(), 20u);
    machine.write();
    machine.write_after(seconds(10));
    const auto answer = machine.ask(hours(1), 1000);
    EXPECT_EQ(value_at(answer, kMonday + 5'500)->mean, 6);
    EXPECT_FALSE(value_at(answer, kMonday + 20'000));
    EXPECT_EQ(value_at(answer, machine.wall_clock - 1000)->mean, 30);
}

/// A change each minute; of the second hour the minutes are left.
void expect_changes_are_too_old(Machine& machine, minutes length) {
    for (int i = 0; i < length.count(); ++i) {
        machine.hold(i % 50, minutes(1));
        if (i % 60 == 0) machine.write();
    }
    machine.write();
    bus::Query query;
    query.board = kTemperature.board;
    query.property = kTemperature.property;
    query.from = wall(kMonday + 3'600'000);
    query.to = wall(kMonday + 7'200'000);
    query.limit = 1000;
    EXPECT_EQ(machine.file->find(query, machine.recorder->present(machine.now())).level, "minutes");
    EXPECT_EQ(machine.ask(hours(1), 1000).level, "changes");
}

TEST(Values, TooOld_ChangesGo_MinutesStay) {
    Machine machine;
    expect_changes_are_too_old(machine, hours(4 * 24));
}

TEST(Values, OtherAges_Hold) {
    Machine machine;
    machine.max_age = {6 * kHourTicks, 3 * kDayTicks, 3 * kDayTicks};
    machine.start();
    expect_changes_are_too_old(machine, hours(16));
}

TEST(Values, TooMuch_OldestChangesGoFirst) {
    Machine machine;
    machine.max_bytes = 400'000;
    machine.start();
    for (int i = 0; i < 3 * 24 * 360; ++i) {
        machine.hold(0.1 * (i % 777), seconds(10));
        if (i % 240 == 0) machine.write();
    }
    machine.write();
    const auto week = machine.ask(hours(72), 1000);
    EXPECT_EQ(week.level, "minutes");
    EXPECT_GT(week.values.size(), 300u);
    for (const auto* file : {"", "-wal"}) {
        std::ifstream size(machine.disk.path() + file, std::ios::ate | std::ios::binary);
        EXPECT_LT(size.tellg(), 800'000) << file;
    }
}

TEST(Values, OnePartOfChangesIsTooMuch_HoursOfBeforeStay) {
    Machine machine;
    machine.hold(1, hours(48));
    machine.write();
    machine.max_bytes = 60'000;
    machine.cut_power(seconds(1));
    for (int i = 0; i < 2 * 36'000; ++i) {
        machine.hold(i, milliseconds(100));
        if (i % 100 == 0) machine.write();
    }
    machine.write();
    const auto before = value_at(machine.ask(hours(60), 10), kMonday + 24 * 3'600'000);
    ASSERT_TRUE(before);
    EXPECT_EQ(before->mean, 1);
}

TEST(Values, PartOfNowIsTooMuch_WhatIsSteadyStaysKnown_AndTheLastMinuteFine) {
    Machine machine;
    machine.max_bytes = 60'000;
    machine.start();
    machine.set(7);
    for (int i = 0; i < 2 * 3600; ++i) {
        machine.set(i % 100, {"desk", "fast"});
        if (i % 10 == 0) machine.set(i % 101, {"desk", "slow"});
        machine.pass(seconds(1));
        if (i % 20 != 0) continue;
        machine.write();
        if (i < 1800) continue;
        const auto steady = machine.ask(minutes(30), 500);
        ASSERT_EQ(steady.values.size(), 1u);
        EXPECT_EQ(steady.values[0], (bus::ValuePoint{wall(machine.wall_clock - 1'800'000), true, 7, 7, 7}));
        EXPECT_EQ(machine.ask(minutes(1), 500).level, "changes");
    }
}

TEST(Values, HourThatIsNotOver_IsKnownAsFarAsItIsWritten) {
    Machine machine;
    for (int minute = 0; minute < 72 * 60 + 31; ++minute) {
        machine.hold(minute % 10, minutes(1));
        if (minute % 10 == 9) machine.write();
    }
    machine.write();  // the hour, too: next time in five minutes
    machine.set(77);
    machine.write_after(seconds(10));
    const auto days = machine.ask(hours(72), 24);
    EXPECT_EQ(days.level, "hours");
    EXPECT_EQ(days.values.back().max, 77);
    EXPECT_TRUE(days.values.front().known);
    machine.write_after(hours(6));
    EXPECT_EQ(machine.ask(hours(72), 24).values.back().mean, 77) << "it holds";
}

TEST(Values, HoursAreTooMany_ThoseOfTheLastDayStay) {
    Machine machine;
    machine.max_bytes = 200'000;
    machine.start();
    for (int hour = 0; hour < 20 * 24; ++hour) {
        for (int i = 0; i < 20; ++i)
            machine.set(hour, {"desk", std::to_string(i)});
        machine.set(hour);
        machine.write_after(hours(1));
        if (hour < 24) continue;
        const auto day = machine.ask(hours(24), 24);
        for (int before = 1; before <= 24; ++before)
            EXPECT_EQ(value_at(day, machine.wall_clock - before * 3'600'000).value_or(bus::ValuePoint()).mean,
                      hour + 1 - before)
                << hour;
    }
}

TEST(Values, PartThatGoes_JournalStaysSmall) {
    constexpr std::uintmax_t kMegabyte = 1'000'000;
    const HistoryFile disk;
    ValueFile::Options options;
    options.path = disk.path();
    options.max_bytes = 60 * kMegabyte;
    ValueFile file(options);
    const auto used = [&](const char* suffix) { return std::filesystem::file_size(disk.path() + suffix); };
    std::uintmax_t journal = 0;
    ValueRows rows;
    rows.stretches = {{0, 5 * kHourTicks, 0}};
    for (int i = 0; i < 10'000; ++i)
        rows.properties.push_back({kTemperature, std::vector<Change>(30), {}, {}});
    for (Tick at = 0; at < 2 * kHourTicks;) {
        for (auto& property : rows.properties)
            for (auto& change : property.changes)
                change = {at++, 0.1};
        ASSERT_TRUE(file.write(rows));
        journal = std::max(journal, used("-wal"));
    }
    EXPECT_GT(used(""), 50 * kMegabyte);
    EXPECT_LT(journal, 50 * kMegabyte);
}

TEST(Values, FileOfALaterVersion_StaysAsItIs) {
    const HistoryFile disk;
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(disk.path().c_str(), &database), SQLITE_OK);
    sqlite3_exec(database, "PRAGMA user_version=2", nullptr, nullptr, nullptr);
    ValueFile::Options options;
    options.path = disk.path();
    EXPECT_THROW(ValueFile{options}, HistoryFault);
    Statement tables(database, "SELECT count(*) FROM sqlite_schema");
    ASSERT_TRUE(tables.step());
    EXPECT_EQ(tables.integer(0), 0);
    sqlite3_close_v2(database);
}

TEST(Values, OneBoard_DoesNotTakeTheNamesOfOthers) {
    Machine machine;
    machine.memory.max_of_board = 2 * ValueFile::kMaxNamesOfBoard;
    machine.start();
    for (std::size_t i = 0; i < ValueFile::kMaxNamesOfBoard + 1; ++i)
        machine.set(1, {"flood", "x/" + std::to_string(i)});
    machine.pass(seconds(1));
    EXPECT_FALSE(machine.file->write(machine.recorder->take(machine.now())));
    machine.hold(20, seconds(1));
    machine.write();
    EXPECT_EQ(machine.ask(hours(1), 10).values.size(), 1u);
}

TEST(Values, FreshPropertiesOfOneBoard_TakeNoPlacesOfOthers) {
    const Recorder::Options limits;
    Machine machine;
    const auto flood = [&machine](std::size_t i) { return PropertyKey{"flood", "x/" + std::to_string(i)}; };
    for (std::size_t i = 0; i < limits.max_properties; ++i) {
        machine.set(1, flood(i));
        machine.recorder->drop(flood(i), machine.now());
    }
    EXPECT_EQ(machine.recorder->size(), limits.max_of_board);
    EXPECT_EQ(machine.recorder->refused(), limits.max_properties - limits.max_of_board);
    machine.hold(20, seconds(1));
    machine.write();
    EXPECT_EQ(machine.ask(hours(1), 10).values.size(), 1u);
    EXPECT_EQ(machine.recorder->size(), 1u) << "those that were dropped leave";
    machine.set(2, flood(0));
    EXPECT_EQ(machine.recorder->size(), 2u) << "there is room again";
}

TEST(Values, FloodOfOneBoard_IsNoGapOfOthers) {
    Machine machine;
    machine.memory.max_waiting = 1000;
    machine.start();
    machine.set(20);
    for (int i = 0; i < 10'000; ++i) {
        machine.set(i, {"flood", "x"});
        machine.pass(milliseconds(1));
    }
    EXPECT_EQ(machine.recorder->dropped(), 0u);
    machine.write();
    EXPECT_EQ(machine.ask(hours(1), 10).values.size(), 1u);
}

TEST(Values, Names_AreGivenPageByPage) {
    Machine machine;
    for (int i = 0; i < 25; ++i)
        machine.set(i, {"desk" + std::to_string(i % 3), "io/" + std::to_string(i) + std::string(250, 'x')});
    machine.write();
    bus::Query query;
    query.find = bus::Find::kValues;
    query.board = "desk*";
    query.limit = 7;
    std::set<std::pair<std::string, std::string>> all;
    std::vector<std::size_t> pages;
    do {
        const auto page = machine.file->find(query, machine.recorder->present(machine.now()));
        pages.push_back(page.kept.size());
        for (const auto& each : page.kept)
            EXPECT_TRUE(all.emplace(each.board, each.property).second);
        query.cursor = page.cursor;
        EXPECT_TRUE(bus::read_registry_request(nlohmann::json::parse(bus::encode({query, {}, {}}))));
    } while (!query.cursor.empty() && pages.size() < 10);
    EXPECT_EQ(pages, (std::vector<std::size_t>{7, 7, 7, 4}));
    EXPECT_EQ(all.size(), 25u);
}

TEST(Values, NumbersBeyondAllMeasure_AreNone) {
    Machine machine;
    for (const double value : {1.7e308, -1.7e308, 1.7e308}) {
        machine.hold(value, seconds(1));
    }
    machine.hold(20, minutes(2));
    machine.write();
    for (const auto& point : machine.ask(hours(1), 1).values)
        EXPECT_TRUE(!point.known || point.mean == 20);
}

TEST(Values, ClockIsSetJustBehindAChange_WhatStaysIsKnown) {
    Machine machine;
    machine.hold(1, hours(1));
    machine.write();
    machine.hold(2, seconds(2));
    machine.wall_clock += 600'000;
    machine.recorder->tick(machine.now());
    machine.write_after(seconds(2));
    machine.write_after(minutes(30));
    const auto now = value_at(machine.ask(hours(2), 1000), machine.wall_clock - 60'000);
    ASSERT_TRUE(now);
    EXPECT_EQ(now->mean, 2);
}

TEST(Values, ClockIsSetByAnHourAtAChange_BothStretchesKnowTheirs) {
    for (const std::int64_t hour : {-3'600'000, 3'600'000}) {
        Machine machine;
        machine.hold(1, hours(1));
        machine.write();
        machine.hold(2, milliseconds(20));
        machine.wall_clock += hour;
        machine.recorder->tick(machine.now());
        machine.write_after(minutes(5));
        const auto now = value_at(machine.ask(minutes(2), 1000), machine.wall_clock - 60'000);
        ASSERT_TRUE(now) << hour;
        EXPECT_EQ(now->max, 2) << hour;
    }
}

TEST(Values, ClocksDifferALittle_KnownUpToNowByTheClock) {
    for (const int differ :
         {1, static_cast<int>(Timeline::kSetBy), -1, -static_cast<int>(Timeline::kSetBy)}) {
        Machine machine;
        machine.hold(1, hours(1));
        machine.wall_clock += differ;
        machine.write();
        EXPECT_TRUE(value_at(machine.ask(minutes(10), 1000), machine.wall_clock)) << differ;
    }
}

TEST(Values, ClockWasSetSinceItWasLookedAt_NothingIsKnownOfTheTimeBetween) {
    Machine machine;
    machine.hold(1, hours(1));
    machine.write();
    machine.wall_clock += 1'800'000;
    EXPECT_FALSE(value_at(machine.ask(hours(1), 1000), machine.wall_clock - 60'000));
}

TEST(Values, DiskTakesLong_WhatIsAskedIsRefusedAtOnceAndAnsweredLater) {
    const HistoryFile kept;
    boost::asio::io_context io;
    const auto work = boost::asio::make_work_guard(io);
    const auto at = [](int milliseconds_) {
        return Instant{Time(milliseconds(milliseconds_)), wall(kMonday + milliseconds_)};
    };
    ValueKeeper keeper(io, {.path = kept.path()}, {}, at(0));
    io.run_one();  // the file is open
    keeper.set(kTemperature, 20, at(100));
    keeper.tick(at(10'000));  // the rows are written; the keeper learns of it when the loop runs
    std::vector<std::string> answers;
    const auto ask = [&](int milliseconds_) {
        bus::Query query;
        query.find = bus::Find::kValues;
        query.board = kTemperature.board;
        query.property = kTemperature.property;
        query.from = wall(kMonday);
        query.to = wall(kMonday + milliseconds_);
        query.limit = 10;
        keeper.find(query, at(milliseconds_),
                    [&](const bus::Answer& answer) { answers.push_back(answer.error); });
    };
    ask(10'100);
    keeper.tick(at(10'900));
    EXPECT_EQ(answers.size(), 0u) << "a disk may take a moment";
    keeper.tick(at(11'000));
    ASSERT_EQ(answers.size(), 1u);
    ask(11'100);
    ASSERT_EQ(answers.size(), 2u);
    for (const auto& each : answers)
        EXPECT_NE(each.find("the disk takes long to write; ask again"), std::string::npos) << each;
    io.run_one();
    io.run_one();
    EXPECT_EQ(answers.size(), 2u) << "each has one answer";
    ask(12'000);
    io.run_one();
    ASSERT_EQ(answers.size(), 3u);
    EXPECT_EQ(answers.back(), "");
}

TEST(Values, Block_SaysWhatWasPacked_CutAnywhereItEnds) {
    const std::vector<Change> changes{{1000, 1.5}, {1000, 0.1}, {99'999'999, kGap}, {100'000'000, -1e300}};
    const auto block = pack_changes(changes, 1000);
    std::vector<Change> read;
    unpack_changes(block, 1000, [&](const Change& change) { read.push_back(change); });
    ASSERT_EQ(read.size(), changes.size());
    for (std::size_t i = 0; i < read.size(); ++i) {
        EXPECT_EQ(read[i].at, changes[i].at);
        EXPECT_TRUE(read[i].value == changes[i].value || std::isnan(changes[i].value));
    }
    for (std::size_t cut = 0; cut < block.size(); ++cut) {
        std::size_t count = 0;
        unpack_changes(std::string_view(block).substr(0, cut), 1000, [&](const Change&) { ++count; });
        EXPECT_LT(count, changes.size());
    }
    unpack_changes(std::string(100, '\xff'), 0, [](const Change&) { FAIL(); });
}

}  // namespace
}  // namespace asip::registry
