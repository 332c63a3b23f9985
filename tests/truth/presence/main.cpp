// SPDX-License-Identifier: Apache-2.0
// The truth test of presence in simulated time: what each program says of a board, compared with what is so.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <thread>
#include <vector>

#include "asip/program/log.hpp"
#include "tests/truth/presence/history.hpp"

namespace {

using SteadyClock = std::chrono::steady_clock;

int replay(std::uint64_t seed) {
    const auto end = truth::presence::run_history(seed, true);
    for (const auto& line : end.trace)
        fmt::print("{}\n", line);
    return end.failure.empty() ? 0 : 1;
}

struct Plan {
    std::uint64_t first = 1;
    double seconds = 10;
    std::uint64_t histories = UINT64_MAX;
    unsigned failures_allowed = 5;
    unsigned threads = 1;
};

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
    fmt::print("{} histories ({:.0f} a minute), {} actions, {} comparisons, {} failed\n", counts.histories,
               static_cast<double>(counts.histories) * 60 / passed(), counts.actions, counts.comparisons,
               failures.load());
    return failures == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app(
        "Checks that every program's view of boards is true, in random histories in simulated time.");
    std::uint64_t seed = 0;
    Plan plan;
    plan.threads = std::max(1U, std::thread::hardware_concurrency());
    auto* const one =
        app.add_option("--seed", seed, "Replay the history of this seed and print what happens");
    app.add_option("--first", plan.first, "Seed of the first history")->capture_default_str();
    app.add_option("--seconds", plan.seconds, "Stop after this time")->capture_default_str();
    app.add_option("--histories", plan.histories, "Stop after so many");
    app.add_option("--threads", plan.threads, "At the same time")->capture_default_str();
    app.add_option("--failures", plan.failures_allowed, "Stop after so many that fail")
        ->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    asip::program::log::configure(asip::program::log::Level::kOff, asip::program::log::Format::kText);
    return *one ? replay(seed) : run(plan);
}
