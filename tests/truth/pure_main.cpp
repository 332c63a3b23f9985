// SPDX-License-Identifier: Apache-2.0
// The truth test in simulated time: histories, one after the other, each from its own seed.
//
// That it can fail was tried with sessions that were broken on purpose, and within how many histories it did:
//   a client is served again before its turn                   1
//   a fence that is missing is no doubt                       12
//   a silent board stays                                      35
//   the digest in the answer to a fence is not compared      385
// Not noticed by it: two measurements under way at once, of which the second may get no value (unit_session
// has a test for that).
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <cstdio>

#include "tests/truth/history.hpp"

namespace {

using SteadyClock = std::chrono::steady_clock;

double seconds_since(SteadyClock::time_point began) {
    return std::chrono::duration<double>(SteadyClock::now() - began).count();
}

void print(const truth::Counts& counts, unsigned failures, double seconds) {
    std::uint64_t faults = 0;
    for (const auto count : counts.faults)
        faults += count;
    fmt::print(
        "{} histories ({:.0f} a minute), {} commands, {} incidents, {} faults of the line:", counts.histories,
        static_cast<double>(counts.histories) * 60 / seconds, counts.commands, counts.incidents, faults);
    for (unsigned i = 0; i < truth::kFaults; ++i)
        fmt::print(" {} {}", counts.faults[i], to_string(static_cast<truth::Fault>(i)));
    fmt::print("\nanswers: refused {}", counts.refused);
    for (unsigned i = 0; i < truth::kOutcomes; ++i)
        fmt::print(", {} {}", to_string(static_cast<truth::Outcome>(i)), counts.outcomes[i]);
    fmt::print(
        "\nhistories with a wrong, late or missing answer: {}; documented exceptions, which left no sign: {} "
        "ok of boards without a digest that executed something else; {} values changed without a checksum, "
        "{} with one; {} reports of before taken for a value, {} errors of another request, {} doubts "
        "because two explanations had the same digest\n",
        failures, counts.not_executed, counts.wrong_values, counts.wrong_summed, counts.old_reports,
        counts.false_errors, counts.equal_digests);
    std::fflush(stdout);
}

int replay(std::uint64_t seed) {
    const auto end = truth::run_history(seed, true);
    for (const auto& line : end.trace)
        fmt::print("{}\n", line);
    print(end.counts, end.failure.empty() ? 0 : 1, 1);
    if (end.failure.empty()) return 0;
    fmt::print("FAILED: {}\n", end.failure);
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app(
        "Checks that every answer of a board session is true, in random histories in simulated time.");
    std::uint64_t seed = 0;
    std::uint64_t first = 1;
    double seconds = 20;
    std::uint64_t histories = UINT64_MAX;
    unsigned failures_allowed = 5;
    auto* const one =
        app.add_option("--seed", seed, "Replay the history of this seed and print all that happens");
    app.add_option("--first", first, "Seed of the first history")->capture_default_str();
    app.add_option("--seconds", seconds, "Stop after this time")->capture_default_str();
    app.add_option("--histories", histories, "Stop after so many");
    app.add_option("--failures", failures_allowed, "Stop after so many failures")->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    if (*one) return replay(seed);

    const auto began = SteadyClock::now();
    auto reported = began;
    truth::Counts counts;
    unsigned failures = 0;
    fmt::print("first seed {}\n", first);
    for (seed = first; seed - first < histories && failures < failures_allowed; ++seed) {
        const auto end = truth::run_history(seed, false);
        counts.add(end.counts);
        if (!end.failure.empty()) {
            ++failures;
            fmt::print("FAILED: {}\n  replay: {} --seed {}\n", end.failure, argv[0], seed);
        }
        if (seconds_since(began) >= seconds) break;
        if (seconds_since(reported) < 60) continue;
        reported = SteadyClock::now();
        fmt::print("seed {}, ", seed);
        print(counts, failures, seconds_since(began));
    }
    print(counts, failures, seconds_since(began));
    return failures == 0 ? 0 : 1;
}
