// SPDX-License-Identifier: Apache-2.0
// The truth test without chance: every single fault, or every pair of two, in every scenario.
//
// That it can fail was seen before asip/session was mended:
//   a setting that the line changed while it was restored stays as it is     scenario "reset between"
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <ctime>

#include "tests/truth/exhaustive/enumerate.hpp"

namespace {

// Every so many histories are played from their beginning, too, and must come to the same.
constexpr std::uint64_t kPlayedTwice = 499;

double processor_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

struct Options {
    std::string only;
    bool pairs = false;
    std::uint64_t every = 1;
    std::uint64_t offset = 0;
    double seconds = 1e9;
    unsigned failures = 10;
    std::uint64_t number = UINT64_MAX;
};

struct Total {
    truth::Counts counts;
    std::uint64_t possible = 0;
    unsigned failures = 0;
    truth::Micros slowest = 0;
    std::string slowest_faults;
};

// The histories of one scenario, numbered.
class Histories {
  public:
    Histories(const truth::TrialEnd& calm, bool pairs)
        : faults_(pairs ? truth::faults_of_pairs(calm) : truth::single_faults(calm)), pairs_(pairs) {}
    std::uint64_t size() const { return pairs_ ? faults_.size() * (faults_.size() - 1) / 2 : faults_.size(); }
    /// Numbers are asked for in order.
    truth::Faults at(std::uint64_t number) {
        if (!pairs_) return faults_[number];
        while (number - before_ >= row_)
            before_ += row_++;
        return truth::pair(faults_[number - before_], faults_[row_]);
    }

  private:
    std::vector<truth::Faults> faults_;
    bool pairs_;
    std::uint64_t row_ = 1;     // pairs are counted row by row: (0,1) (0,2) (1,2) (0,3) ...
    std::uint64_t before_ = 0;  // pairs in the rows before
};

void print(const std::vector<std::string>& trace) {
    for (const auto& line : trace)
        fmt::print("{}\n", line);
}

void play(const truth::Scenario& scenario, const Options& options, Total& total) {
    const auto began = processor_seconds();
    const truth::Undisturbed undisturbed(scenario);
    const auto& calm = undisturbed.end();
    total.counts.add(calm.counts);
    if (!calm.failure.empty()) {
        ++total.failures;
        fmt::print("FAILED: {}, undisturbed: {}\n", scenario.name, calm.failure);
        print(truth::run_trial(scenario, {}, 0, true).trace);
        return;
    }
    Histories histories(calm, options.pairs);
    total.possible += histories.size();
    truth::Counts counts;
    for (std::uint64_t number = options.offset; number < histories.size(); number += options.every) {
        if (options.number != UINT64_MAX && number != options.number) continue;
        if (total.failures >= options.failures || processor_seconds() > options.seconds) break;
        const auto faults = histories.at(number);
        auto end = undisturbed.run(faults);
        if (options.number == number || counts.histories % kPlayedTwice == 0) {
            const auto whole = truth::run_trial(scenario, faults, calm.ready_at, options.number == number);
            if (!whole.same(end) && end.failure.empty())
                end.failure = "it ends in another way when it is played from its beginning";
            print(whole.trace);
        }
        counts.add(end.counts);
        if (end.recovered_after > total.slowest) {
            total.slowest = end.recovered_after;
            total.slowest_faults = scenario.name + ": " + describe(faults);
        }
        if (end.failure.empty()) continue;
        ++total.failures;
        fmt::print("FAILED: {}: {}: {}\n  replay: --scenario \"{}\"{} --number {}\n", scenario.name,
                   describe(faults), end.failure, scenario.name, options.pairs ? " --pairs" : "", number);
    }
    fmt::print(
        "{:45} {:9} of {:10} {:6.1f} s  {} + {} bytes, {} moments; false and excused: {} ok, {} + {} "
        "values\n",
        scenario.name, counts.histories, histories.size(), processor_seconds() - began,
        calm.to_board.until - calm.to_board.from, calm.to_host.until - calm.to_host.from, calm.moments.size(),
        counts.not_executed, counts.wrong_values, counts.wrong_summed);
    std::fflush(stdout);
    total.counts.add(counts);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app(
        "Checks that every answer of a board session is true, whatever single fault befalls its line.");
    Options options;
    app.add_option("--scenario", options.only, "Only the scenario of this name");
    app.add_flag("--pairs", options.pairs, "Every pair of two faults in place of every single one");
    app.add_option("--every", options.every, "Only every Nth history")->check(CLI::PositiveNumber);
    app.add_option("--offset", options.offset, "Beginning with this one");
    app.add_option("--number", options.number,
                   "Replay this history of the scenario and print all that happens");
    app.add_option("--seconds", options.seconds, "Stop after so much processor time");
    app.add_option("--failures", options.failures, "Stop after so many failures")->capture_default_str();
    CLI11_PARSE(app, argc, argv);

    Total total;
    for (const auto& scenario : truth::scenarios())
        if (options.only.empty() || scenario.name == options.only) play(scenario, options, total);
    const auto& counts = total.counts;
    fmt::print("{} histories of {} with {}, {} commands, {:.1f} s of processor time; {} wrong\n",
               counts.histories, total.possible, options.pairs ? "two faults" : "one fault", counts.commands,
               processor_seconds(), total.failures);
    fmt::print("answers: refused {}", counts.refused);
    for (unsigned i = 0; i < truth::kOutcomes; ++i)
        fmt::print(", {} {}", to_string(static_cast<truth::Outcome>(i)), counts.outcomes[i]);
    fmt::print(
        "\ndocumented exceptions, without a sign: {} ok of boards without a digest, {} values without a "
        "checksum, "
        "{} with one\nrestarted boards that the line made another one, whose settings were not restored: "
        "{}\nslowest "
        "recovery: {:.3f} s, {}\n",
        counts.not_executed, counts.wrong_values, counts.wrong_summed, counts.not_restored,
        static_cast<double>(total.slowest) * 1e-6, total.slowest_faults);
    return total.failures == 0 && counts.histories > 0 ? 0 : 1;
}
