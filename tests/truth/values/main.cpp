// SPDX-License-Identifier: Apache-2.0
// The truth test of properties in simulated time: what each view says of a board's values, compared with what
// the board did.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <vector>

#include "tests/truth/values/history.hpp"

namespace {

using SteadyClock = std::chrono::steady_clock;
constexpr unsigned kReadsBesideALamp = 5000;
constexpr double kLeastKnown = 0.3;  // of all looks: a view that knows nothing is never wrong

int replay(const std::vector<std::uint64_t>& seeds) {
    bool good = true;
    for (const auto seed : seeds) {
        const auto end = truth::values::run_history(seed, true);
        for (const auto& line : end.trace)
            fmt::print("{}\n", line);
        fmt::print("{}\n", end.failure.empty() ? "right" : end.failure);
        good = good && end.failure.empty();
    }
    return good ? 0 : 1;
}

int run(std::uint64_t first, std::uint64_t histories, double seconds) {
    const auto began = SteadyClock::now();
    const auto lamp = truth::values::run_lamp(first, kReadsBesideALamp);
    if (!lamp.failure.empty()) {
        fmt::print("beside {} reads: {}\n", kReadsBesideALamp, lamp.failure);
        return 1;
    }
    std::uint64_t done = 0, looks = 0, known = 0, reads = 0, wrong = 0;
    for (; done < histories && wrong < 5; ++done) {
        if (std::chrono::duration<double>(SteadyClock::now() - began).count() > seconds) break;
        const auto end = truth::values::run_history(first + done, false);
        looks += end.looks;
        known += end.known;
        reads += end.reads;
        if (end.failure.empty()) continue;
        ++wrong;
        fmt::print("seed {}: {}\n", first + done, end.failure);
    }
    fmt::print("{} histories, {} values compared, {} of them known, {} reads: {} wrong\n", done, looks, known,
               reads, wrong);
    if (static_cast<double>(known) < kLeastKnown * static_cast<double>(looks)) {
        fmt::print("too little is known\n");
        return 1;
    }
    return wrong == 0 && done > 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("How a board stands, as each view says it, in random histories");
    std::uint64_t first = 1, histories = 300;
    double seconds = 600;
    std::vector<std::uint64_t> seeds;
    app.add_option("--first", first, "Seed of the first history");
    app.add_option("--histories", histories, "How many");
    app.add_option("--seconds", seconds, "At most so long");
    app.add_option("--seed", seeds, "Replay these, and print what happens");
    CLI11_PARSE(app, argc, argv);
    return seeds.empty() ? run(first, histories, seconds) : replay(seeds);
}
