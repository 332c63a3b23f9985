// SPDX-License-Identifier: Apache-2.0
// The truth test without chance: every single fault, in every scenario.
//
// That it can fail was seen before asip/session was mended:
//   a setting that the line changed while it was restored stays as it is     scenario "reset between"
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "tests/truth/exhaustive/enumerate.hpp"

namespace {

double processor_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

struct Options {
    std::string only;
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

void print(const std::vector<std::string>& trace) {
    for (const auto& line : trace)
        fmt::print("{}\n", line);
}

// The histories of one scenario.
class Play {
  public:
    Play(const truth::Scenario& scenario, const Options& options, Total& total)
        : scenario_(scenario),
          options_(options),
          total_(total),
          calm_(truth::run_trial(scenario, {}, {}, false)) {}

    void run() {
        total_.counts.add(calm_.counts);
        if (!calm_.failure.empty()) {
            ++total_.failures;
            fmt::print("FAILED: {}, undisturbed: {}\n", scenario_.name, calm_.failure);
            print(truth::run_trial(scenario_, {}, {}, true).trace);
            return;
        }
        const auto histories = truth::single_faults(calm_);
        total_.possible += histories.size();
        if (options_.number != UINT64_MAX) {
            if (options_.number < histories.size()) replay(histories);
        } else {
            each(histories);
        }
    }

  private:
    bool enough() const {
        return total_.failures >= options_.failures || processor_seconds() > options_.seconds;
    }

    void replay(const std::vector<truth::Faults>& histories) {
        auto end = truth::run_trial(scenario_, histories.at(options_.number), calm_.times, true);
        print(end.trace);
        note(histories, options_.number, end);
    }

    void each(const std::vector<truth::Faults>& histories) {
        for (auto number = options_.offset; number < histories.size() && !enough();
             number += options_.every) {
            auto end = truth::run_trial(scenario_, histories.at(number), calm_.times, false);
            note(histories, number, end);
        }
        report(histories);
    }

    void note(const std::vector<truth::Faults>& histories, std::uint64_t number, const truth::TrialEnd& end) {
        counts_.add(end.counts);
        if (end.recovered_after > total_.slowest) {
            total_.slowest = end.recovered_after;
            total_.slowest_faults = scenario_.name + ": " + describe(histories.at(number));
        }
        if (end.failure.empty()) return;
        ++total_.failures;
        ++failures_;
        fmt::print("FAILED: {}: {}: {}\n  replay: --scenario \"{}\" --number {}\n", scenario_.name,
                   describe(histories.at(number)), end.failure, scenario_.name, number);
    }

    void report(const std::vector<truth::Faults>& histories) {
        fmt::print(
            "{:45} {:9} of {:10} {:6.1f} s  {} + {} bytes, {} moments; false and excused: {} ok, {} + {} "
            "values\n",
            scenario_.name, counts_.histories, histories.size(), processor_seconds() - began_,
            calm_.to_board.until - calm_.to_board.from, calm_.to_host.until - calm_.to_host.from,
            calm_.moments.size(), counts_.not_executed, counts_.wrong_values, counts_.wrong_summed);
        std::fflush(stdout);
        total_.counts.add(counts_);
    }

    const truth::Scenario& scenario_;
    const Options& options_;
    Total& total_;
    double began_ = processor_seconds();
    truth::TrialEnd calm_;  // the history in which nothing goes wrong
    truth::Counts counts_;
    unsigned failures_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
    CLI::App app(
        "Checks that every answer of a board session is true, whatever single fault befalls its line.");
    Options options;
    app.add_option("--scenario", options.only, "Only the scenario of this name");
    app.add_option("--every", options.every, "Only every Nth history")->check(CLI::PositiveNumber);
    app.add_option("--offset", options.offset, "Beginning with this one");
    app.add_option("--number", options.number,
                   "Replay this history of the scenario and print all that happens");
    app.add_option("--seconds", options.seconds, "Stop after so much processor time");
    app.add_option("--failures", options.failures, "Stop after so many failures")->capture_default_str();
    CLI11_PARSE(app, argc, argv);

    Total total;
    for (const auto& scenario : truth::scenarios())
        if ((options.only.empty() || scenario.name == options.only)) Play(scenario, options, total).run();
    const auto& counts = total.counts;
    fmt::print("{} histories of {} with one fault, {} commands, {:.1f} s of processor time; {} wrong\n",
               counts.histories, total.possible, counts.commands, processor_seconds(), total.failures);
    fmt::print("answers: refused {}", counts.refused);
    for (unsigned i = 0; i < truth::kOutcomes; ++i)
        fmt::print(", {} {}", to_string(static_cast<truth::Outcome>(i)), counts.outcomes[i]);
    fmt::print(
        "\ndocumented exceptions, without a sign: {} ok of boards without a digest, {} values without a "
        "checksum, {} with one\nslowest recovery: {:.3f} s, {}\n",
        counts.not_executed, counts.wrong_values, counts.wrong_summed,
        static_cast<double>(total.slowest) * 1e-6, total.slowest_faults);
    return total.failures == 0 && counts.histories > 0 ? 0 : 1;
}
