// SPDX-License-Identifier: Apache-2.0
// The truth test with everything real: firmware in simulated boards behind a damaged line, agents, Mosquitto,
// clients over MQTT and TCP. What the LEDs at the boards' pins showed is compared with each answer.
//
// That it can fail was tried with agents that were broken on purpose; what it then said, within three or four
// rounds:
//   answers ok at once                    ok and not executed, a bad command was ok
//   loses each 50th answer                never answered
//   sends each 20th command twice         sent to the board twice
//   stands still after 14 s               never answered (also at a load of 30 on two processors)
// Not noticed within three rounds: commands refused without a board and sent when it is back, a
// point-to-point client that does not learn what was damaged (unit_agent has tests for both).
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <stdexcept>

#include "tests/truth/live/round.hpp"

namespace {

constexpr std::uint64_t kMaxNotBegun = 3;

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Checks that every answer of agents is true, with real firmware, broker and processes.");
    std::uint64_t first = 1;
    int rounds = 1;
    double seconds = 0;
    double active = 8;
    app.add_option("--first", first, "Seed of the first round")->capture_default_str();
    app.add_option("--rounds", rounds, "How many rounds")->capture_default_str();
    app.add_option("--seconds", seconds, "Instead: rounds until then");
    app.add_option("--active", active, "Seconds of commands in a round")->capture_default_str();
    std::string pico;
    app.add_option("--pico", pico,
                   "The board with our firmware is a Pico, which this script runs (ASIP_RP2040JS)");
    CLI11_PARSE(app, argc, argv);
    truth::Counts counts;
    const auto end = truth::now_ms() + static_cast<std::int64_t>(seconds * 1000);
    for (std::uint64_t seed = first;
         seconds > 0 ? truth::now_ms() < end : seed < first + static_cast<unsigned>(rounds); ++seed) {
        std::unique_ptr<truth::Round> round;
        try {
            round = std::make_unique<truth::Round>(seed, counts, pico);
        } catch (const std::runtime_error& error) {
            // Another program may have taken a port that was free.
            fmt::print("seed {}: not begun: {}\n", seed, error.what());
            if (++counts.not_begun > kMaxNotBegun) return 1;
            continue;
        }
        round->run(static_cast<std::int64_t>(active * 1000));
        fmt::print(
            "seed {}: {} commands, {} incidents, {} faults of the line; ok {}, error {}, doubt {}, timeout "
            "{}, refused {}, repeated {}, unanswered while agent or broker was gone {}, late on a starved "
            "machine {}; false ok without a checksum that left no sign {}; own connection lost {}; delivered "
            "again after the broker's death {}; wrong answers {}\n",
            seed, counts.commands, counts.incidents, counts.faults, counts.ok, counts.error, counts.doubt,
            counts.timeout, counts.refused, counts.repeated, counts.nobody_there, counts.starved,
            counts.invisible, counts.own_reconnects, counts.redelivered, counts.failures);
        std::fflush(stdout);
    }
    return counts.failures == 0 && counts.commands > 0 ? 0 : 1;
}
