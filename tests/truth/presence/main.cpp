// SPDX-License-Identifier: Apache-2.0
// The truth test of presence in simulated time: what each program says of a board, compared with what is so.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "asip/program/log.hpp"
#include "tests/truth/presence/history.hpp"

namespace {

using SteadyClock = std::chrono::steady_clock;

int replay(const std::vector<std::uint64_t>& seeds, const std::string& watched) {
    bool good = true;
    for (const auto seed : seeds) {
        const auto end = truth::presence::run_history(seed, true, watched);
        for (const auto& line : end.trace)
            fmt::print("{}\n", line);
        good = good && end.failure.empty();
    }
    return good ? 0 : 1;
}

// Each kind of start must come in so many histories.
constexpr std::uint64_t kHistoriesOfEachStart = 100;
constexpr std::uint64_t kEnoughToCount = 10'000;

struct Plan {
    std::uint64_t first = 1;
    double seconds = 10;
    std::uint64_t histories = UINT64_MAX;
    unsigned failures_allowed = 5;
    unsigned threads = 1;
};

/// Writes what bus views got in histories, and what they said, for the tests of other languages.
int record(const Plan& plan, const std::string& path) {
    std::vector<std::string> recorded;
    for (std::uint64_t number = 0; number < plan.histories; ++number) {
        const auto end = truth::presence::run_history(plan.first + number, false, {}, &recorded);
        if (end.failure.empty()) continue;
        fmt::print("FAILED: seed {}: {}\n", plan.first + number, end.failure);
        return 1;
    }
    std::ofstream file(path);
    file << "{\"histories\": [\n" << fmt::format("{}", fmt::join(recorded, ",\n")) << "\n]}\n";
    return file.good() ? 0 : 1;
}

int run(const Plan& plan) {
    const auto began = SteadyClock::now();
    const auto passed = [&] { return std::chrono::duration<double>(SteadyClock::now() - began).count(); };
    std::atomic<std::uint64_t> next{0};
    std::atomic<unsigned> failures{0};
    std::mutex mutex;
    truth::presence::Counts counts;
    const auto work = [&] {
        while (failures < plan.failures_allowed && passed() < plan.seconds) {
            const auto number = next++;
            if (number >= plan.histories) return;
            const auto end = truth::presence::run_history(plan.first + number, false);
            const std::lock_guard lock(mutex);
            counts += end.counts;
            if (end.failure.empty()) continue;
            ++failures;
            fmt::print("FAILED: seed {}: {}\n", plan.first + number, end.failure);
        }
    };
    std::vector<std::thread> others;
    for (unsigned i = 1; i < plan.threads; ++i)
        others.emplace_back(work);
    work();
    for (auto& thread : others)
        thread.join();
    const auto histories = static_cast<double>(counts.histories);
    fmt::print(
        "{} histories ({:.0f} a second), {} actions, {} contests, {} misses, {} comparisons, {} failed\n",
        counts.histories, histories / passed(), counts.actions, counts.contests, counts.misses,
        counts.comparisons, failures.load());
    for (const auto& line : counts.starts.lines())
        fmt::print("{}\n", line);
    const auto rarest = std::min({counts.starts.rarest(), counts.contests, counts.misses});
    const bool rare = counts.histories >= kEnoughToCount && rarest < counts.histories / kHistoriesOfEachStart;
    if (rare) fmt::print("FAILED: a kind of start or end is rarer than in each hundredth history\n");
    return failures == 0 && !rare ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app(
        "Checks that every program's view of boards is true, in random histories in simulated time.");
    std::vector<std::uint64_t> seeds;
    std::string watched, vectors;
    Plan plan;
    plan.threads = std::max(1U, std::thread::hardware_concurrency());
    app.add_option("--seed", seeds, "Replay the histories of these seeds and print what happens");
    app.add_option("--watch", watched, "With --seed: print what this view gets, such as \"registry r1\"");
    app.add_option("--first", plan.first, "Seed of the first history")->capture_default_str();
    app.add_option("--seconds", plan.seconds, "Stop after this time")->capture_default_str();
    app.add_option("--histories", plan.histories, "Stop after so many");
    app.add_option("--threads", plan.threads, "At the same time")->capture_default_str();
    app.add_option("--failures", plan.failures_allowed, "Stop after so many that fail")
        ->capture_default_str();
    app.add_option("--record", vectors,
                   "Write what programs hear in --histories of them, and what they say, to this file: "
                   "python/tests/test_presence.py and node-red/tests/presence.test.mjs read it")
        ->needs("--histories");
    CLI11_PARSE(app, argc, argv);
    asip::program::log::configure(asip::program::log::Level::kOff, asip::program::log::Format::kText);
    if (!vectors.empty()) return record(plan, vectors);
    return seeds.empty() ? run(plan) : replay(seeds, watched);
}
