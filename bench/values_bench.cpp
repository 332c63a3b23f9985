// SPDX-License-Identifier: Apache-2.0
// Values that a registry keeps: what 2,000 changes a second cost beside plain inserts of the same, and how
// long a week of one of 1,000 properties (or as many as the argument says) takes.
#include <sys/resource.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "bench/figures.hpp"
#include "registry/values/value_file.hpp"
#include "tests/support/temp_dir.hpp"

namespace {

using namespace asip;
using namespace asip::registry;
using namespace std::chrono_literals;

constexpr std::int64_t kBegin = 1'700'006'400'000;
constexpr int kWeekMinutes = 7 * 24 * 60;

Instant moment(std::int64_t milliseconds) {
    return {Time(std::chrono::milliseconds(milliseconds)),
            text::WallTime(std::chrono::milliseconds(kBegin + milliseconds))};
}

std::vector<PropertyKey> keys(int count) {
    std::vector<PropertyKey> result;
    for (int i = 0; i < count; ++i)
        result.push_back({"board" + std::to_string(i / 4), "sensor/" + std::to_string(i % 4)});
    return result;
}

/// As a sensor has it: a number of few digits that wanders.
double value_of(int property, int turn) {
    return std::round(200 + 50 * std::sin(0.01 * turn + property) + (turn * 7 + property) % 5) / 10;
}

double processor_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec) * 1e-6;
}

double bytes_of(const std::string& file) {
    double bytes = 0;
    for (const char* part : {"", "-wal"})
        if (std::filesystem::exists(file + part))
            bytes += static_cast<double>(std::filesystem::file_size(file + part));
    return bytes;
}

struct Cost {
    double processor, bytes;  // of one change
};

constexpr int kSeconds = 600, kProperties = 1000, kAgain = 2;
constexpr double kChanges = 1.0 * kSeconds * kProperties * kAgain;

Cost kept(const std::string& path) {
    const auto all = keys(kProperties);
    const double before = processor_seconds();
    {
        ValueFile file({.path = path});
        Recorder recorder;
        recorder.begin(std::nullopt, moment(0));
        for (int turn = 1; turn <= kSeconds * kAgain; ++turn) {
            for (int i = 0; i < kProperties; ++i)
                recorder.set(all[static_cast<std::size_t>(i)], value_of(i, turn),
                             moment(turn * 1000 / kAgain));
            if (turn % (10 * kAgain) == 0) file.write(recorder.take(moment(turn * 1000 / kAgain)));
        }
    }
    return {(processor_seconds() - before) / kChanges, bytes_of(path) / kChanges};
}

Cost plain(const std::string& path) {
    sqlite3* database = nullptr;
    sqlite3_open(path.c_str(), &database);
    const auto run = [&](const char* sql) { sqlite3_exec(database, sql, nullptr, nullptr, nullptr); };
    const double before = processor_seconds();
    run("PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL;"
        "CREATE TABLE changes(property INTEGER, at INTEGER, value REAL)");
    {
        Statement insert(database, "INSERT INTO changes VALUES(?,?,?)");
        for (int turn = 1; turn <= kSeconds * kAgain; ++turn) {
            if (turn % (10 * kAgain) == 1) run("BEGIN");
            for (int i = 0; i < kProperties; ++i)
                insert.reset()
                    .bind(std::int64_t{i})
                    .bind(kBegin + turn * 1000 / kAgain)
                    .bind_real(value_of(i, turn))
                    .step();
            insert.reset();
            if (turn % (10 * kAgain) == 0) run("COMMIT");
        }
    }
    sqlite3_close_v2(database);
    return {(processor_seconds() - before) / kChanges, bytes_of(path) / kChanges};
}

void week(const std::string& path, int properties) {
    const auto all = keys(properties);
    ValueFile file({.path = path});
    Recorder recorder;
    recorder.begin(std::nullopt, moment(0));
    for (int minute = 1; minute <= kWeekMinutes; ++minute) {
        const auto now = moment(minute * 60'000LL);
        for (int i = 0; i < properties; ++i)
            recorder.set(all[static_cast<std::size_t>(i)], value_of(i, minute), now);
        if (minute % 60 == 0) file.write(recorder.take(now));
    }
    const auto end = moment(kWeekMinutes * 60'000LL);
    std::vector<double> times, processor;
    for (int i = 0; i < 100; ++i) {
        bus::Query query;
        query.find = bus::Find::kValues;
        query.board = all[static_cast<std::size_t>(i * 37 % properties)].board;
        query.property = all[static_cast<std::size_t>(i * 37 % properties)].property;
        query.to = end.wall;
        query.from = end.wall - std::chrono::hours(7 * 24);
        query.limit = 1000;
        const auto begin = Clock::now();
        const double before = processor_seconds();
        const auto answer = file.find(query, recorder.present(end));
        if (answer.values.size() < 900) std::printf("only %zu points\n", answer.values.size());
        times.push_back(bench::Milliseconds(Clock::now() - begin).count());
        processor.push_back((processor_seconds() - before) * 1000);
    }
    const auto latency = bench::summary(times);
    bench::row("values: a week of one of many properties, 1,000 points, median", latency.p50, "ms", 30, 10);
    std::printf("of that, processor time: %.2f ms\n", bench::median(processor));
    bench::row("values: the same, 99 of 100 within", latency.p99, "ms", 30, 10);
}

}  // namespace

int main(int argc, char** argv) {
    const asip::test::TempDir folder;
    const Cost ours = kept(folder.file("kept.db")), theirs = plain(folder.file("plain.db"));
    std::printf(
        "2,000 changes a second: %.2f us and %.1f bytes a change; plain inserts %.2f us and %.1f bytes\n",
        ours.processor * 1e6, ours.bytes, theirs.processor * 1e6, theirs.bytes);
    bench::row("values: processor of a change, beside a plain insert", ours.processor / theirs.processor, "x",
               2, 1.3);
    bench::row("values: bytes of a change, beside a plain insert", ours.bytes / theirs.bytes, "x", 2, 1.3);
    week(folder.file("week.db"), argc > 1 ? std::atoi(argv[1]) : 1000);
}
