// SPDX-License-Identifier: Apache-2.0
// The truth test without chance: every single fault, or every pair of two, in every scenario.
//
// That it can fail was seen before asip/session was mended:
//   a setting that the line changed while it was restored stays as it is     scenario "reset between"
//   an error of a setting that is restored is no sign of damage     --pairs, "reset between, ASIP 0.4"
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

#include "tests/truth/exhaustive/enumerate.hpp"
#include "tests/truth/exhaustive/pairs.hpp"

namespace {

// Every so many histories are played from their beginning to their end, too, and must come to the same.
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
    std::string log;
};

struct Total {
    truth::Counts counts;
    std::uint64_t possible = 0;
    std::uint64_t equal_states = 0;
    std::uint64_t covered = 0;
    unsigned failures = 0;
    truth::Micros slowest = 0;
    std::string slowest_faults;
};

// The histories of one scenario, numbered. Pairs row by row: (0,1) (0,2) (1,2) (0,3) ...
class Histories {
  public:
    Histories(const truth::TrialEnd& calm, bool pairs)
        : faults_(pairs ? truth::faults_of_pairs(calm) : truth::single_faults(calm)), pairs_(pairs) {}
    std::uint64_t size() const { return pairs_ ? faults_.size() * (faults_.size() - 1) / 2 : faults_.size(); }
    truth::Faults at(std::uint64_t number) const {
        if (!pairs_) return faults_[number];
        auto row = static_cast<std::uint64_t>((1 + std::sqrt(1 + 8 * static_cast<double>(number))) / 2);
        while (row * (row - 1) / 2 > number)
            --row;
        while (row * (row + 1) / 2 <= number)
            ++row;
        return truth::both(faults_[number - row * (row - 1) / 2], faults_[row]);
    }
    static std::uint64_t number_of(std::uint64_t one, std::uint64_t other) {
        const auto row = std::max(one, other);
        return row * (row - 1) / 2 + std::min(one, other);
    }
    const std::vector<truth::Faults>& faults() const { return faults_; }

  private:
    std::vector<truth::Faults> faults_;
    bool pairs_;
};

void print(const std::vector<std::string>& trace) {
    for (const auto& line : trace)
        fmt::print("{}\n", line);
}

// The histories of one scenario.
class Play {
  public:
    Play(const truth::Scenario& scenario, const Options& options, Total& total)
        : scenario_(scenario), options_(options), total_(total), undisturbed_(scenario) {}

    void run() {
        const auto& calm = undisturbed_.end();
        total_.counts.add(calm.counts);
        if (!calm.failure.empty()) {
            ++total_.failures;
            fmt::print("FAILED: {}, undisturbed: {}\n", scenario_.name, calm.failure);
            print(truth::run_trial(scenario_, {}, {}, true).trace);
            return;
        }
        const Histories histories(calm, options_.pairs);
        total_.possible += histories.size();
        if (options_.number != UINT64_MAX) {
            if (options_.number < histories.size()) replay(histories);
        } else if (options_.pairs && options_.every == 1) {
            all_pairs(histories);
        } else {
            each(histories);
        }
    }

  private:
    bool enough() const {
        return total_.failures >= options_.failures || processor_seconds() > options_.seconds;
    }

    void replay(const Histories& histories) {
        auto end = truth::run_trial(scenario_, histories.at(options_.number), undisturbed_.end().times, true);
        print(end.trace);
        note(histories, options_.number, end);
    }

    void each(const Histories& histories) {
        for (auto number = options_.offset; number < histories.size() && !enough();
             number += options_.every) {
            auto end = undisturbed_.run(histories.at(number));
            note(histories, number, end);
        }
        report(histories, "");
    }

    void all_pairs(const Histories& histories) {
        truth::Pairs pairs(undisturbed_, histories.faults(),
                           [&](std::size_t one, std::size_t other, truth::TrialEnd& end) {
                               note(histories, Histories::number_of(one, other), end);
                               return !enough();
                           });
        const auto count = pairs.run();
        total_.equal_states += count.equal;
        total_.covered += count.pairs - count.played;
        if (!enough()) keep(count);
        report(histories, fmt::format("{} of them until an equal state, {} covered by others; ", count.equal,
                                      count.pairs - count.played));
    }

    // One line a scenario: what is in it need not be played again.
    void keep(const truth::Pairs::Count& count) {
        if (options_.log.empty()) return;
        std::ofstream(options_.log, std::ios::app) << fmt::format(
            "{}: {} pairs: {} played, {} of them until an equal state, {} covered by others; "
            "{} wrong; excused {} ok, {} + {} values, {} restarts; {:.0f} s of processor time\n",
            scenario_.name, count.pairs, count.played, count.equal, count.pairs - count.played, failures_,
            counts_.not_executed, counts_.wrong_values, counts_.wrong_summed, counts_.not_restored,
            processor_seconds() - began_);
    }

    void note(const Histories& histories, std::uint64_t number, truth::TrialEnd& end) {
        if (counts_.histories % kPlayedTwice == 0) {
            const auto whole =
                truth::run_trial(scenario_, histories.at(number), undisturbed_.end().times, false);
            const bool same = whole.failure == end.failure &&
                              truth::excused_of(whole.counts) == truth::excused_of(end.counts);
            if (!same && end.failure.empty())
                end.failure = "it ends in another way when it is played from its beginning";
        }
        counts_.add(end.counts);
        if (end.recovered_after > total_.slowest) {
            total_.slowest = end.recovered_after;
            total_.slowest_faults = scenario_.name + ": " + describe(histories.at(number));
        }
        if (end.failure.empty()) return;
        ++total_.failures;
        ++failures_;
        fmt::print("FAILED: {}: {}: {}\n  replay: --scenario \"{}\"{} --number {}\n", scenario_.name,
                   describe(histories.at(number)), end.failure, scenario_.name,
                   options_.pairs ? " --pairs" : "", number);
    }

    void report(const Histories& histories, const std::string& more) {
        const auto& calm = undisturbed_.end();
        fmt::print(
            "{:45} {:9} of {:10} {}{:6.1f} s  {} + {} bytes, {} moments; false and excused: {} ok, {} + {} "
            "values\n",
            scenario_.name, counts_.histories, histories.size(), more, processor_seconds() - began_,
            calm.to_board.until - calm.to_board.from, calm.to_host.until - calm.to_host.from,
            calm.moments.size(), counts_.not_executed, counts_.wrong_values, counts_.wrong_summed);
        std::fflush(stdout);
        total_.counts.add(counts_);
    }

    const truth::Scenario& scenario_;
    const Options& options_;
    Total& total_;
    double began_ = processor_seconds();
    truth::Undisturbed undisturbed_;
    truth::Counts counts_;
    unsigned failures_ = 0;
};

// Whether the log has all pairs of the scenario already.
bool is_done(const std::string& log, const std::string& scenario) {
    std::ifstream file(log);
    for (std::string line; std::getline(file, line);)
        if (line.starts_with(scenario + ": ")) return true;
    return false;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app(
        "Checks that every answer of a board session is true, whatever single fault befalls its line.");
    Options options;
    app.add_option("--scenario", options.only, "Only the scenario of this name");
    app.add_flag("--pairs", options.pairs, "Every pair of two faults in place of every single one");
    app.add_option(
        "--log", options.log,
        "With --pairs: add the result of each scenario to this file, and pass over those that it has");
    app.add_option("--every", options.every, "Only every Nth history")->check(CLI::PositiveNumber);
    app.add_option("--offset", options.offset, "Beginning with this one");
    app.add_option("--number", options.number,
                   "Replay this history of the scenario and print all that happens");
    app.add_option("--seconds", options.seconds, "Stop after so much processor time");
    app.add_option("--failures", options.failures, "Stop after so many failures")->capture_default_str();
    CLI11_PARSE(app, argc, argv);

    Total total;
    for (const auto& scenario : truth::scenarios())
        if ((options.only.empty() || scenario.name == options.only) && !is_done(options.log, scenario.name))
            Play(scenario, options, total).run();
    const auto& counts = total.counts;
    if (total.covered > 0)
        fmt::print("{} of the histories until a state that was known, {} pairs covered by others\n",
                   total.equal_states, total.covered);
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
    return total.failures == 0 && (counts.histories > 0 || !options.log.empty()) ? 0 : 1;
}
