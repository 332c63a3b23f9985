// SPDX-License-Identifier: Apache-2.0
// How many boards asip-sim runs in real time on this machine: processor time, the pace of simulated time
// against the wall clock, and the time of a round trip over the pseudo-terminals while all of them run.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include "tests/integration/sim/sim_program.hpp"
#include "tests/integration/sim/tty_client.hpp"

namespace {

using namespace asip::test;
using SteadyClock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr auto kMeasured = std::chrono::seconds(10);

struct Measured {
    double processors;  ///< of 1 core
    double pace;        ///< simulated seconds in a second, of the slowest board
    double median_ms;   ///< round trip
    double p99_ms;
    int behind;  ///< times a board gave up catching up
    int unanswered;
};

std::vector<double> reset_times(const std::string& output, const std::string& board) {
    std::vector<double> times;
    const std::regex line(board + R"( ([0-9.]+) reset cause=external)");
    for (std::sregex_iterator it(output.begin(), output.end(), line), end; it != end; ++it)
        times.push_back(std::stod((*it)[1]));
    return times;
}

/// A reset prints the board's simulated time: two of them with the wall clock between give its pace.
std::vector<SteadyClock::time_point> reset_all(SimProgram& sim, int boards) {
    std::vector<SteadyClock::time_point> when;
    for (int i = 0; i < boards; ++i) {
        sim.control({"reset", "b" + std::to_string(i)});
        when.push_back(SteadyClock::now());
    }
    return when;
}

Measured measure(int boards) {
    const TempDir folder;
    std::vector<std::string> arguments;
    for (int i = 0; i < boards; ++i)
        arguments.push_back(
            folder.write(fmt::format("b{}.json", i), fmt::format(R"({{"image": "{}", "parts": [
            {{"kind": "square-wave", "name": "wave", "pin": 2, "hertz": 20}},
            {{"kind": "ultrasonic", "name": "sonar", "pin": 7}}]}})",
                                                                 SERVICES_IMAGE)));
    SimProgram sim(folder, arguments, boards);
    std::vector<StreamClient> clients;
    const auto output = sim.process().output();
    const std::regex port("port path=(\\S+)");
    for (std::sregex_iterator it(output.begin(), output.end(), port), end; it != end; ++it)
        clients.push_back(StreamClient::terminal((*it)[1]));

    const auto first = reset_all(sim, boards);
    for (auto& client : clients)
        client.expect("running on");
    std::vector<double> trips;
    int unanswered = 0;
    const auto before = sim.process().processor_time();
    const auto start = SteadyClock::now();
    while (SteadyClock::now() - start < kMeasured) {
        auto& client = clients[trips.size() % clients.size()];
        const auto asked = SteadyClock::now();
        client.write("#,E,x\n");
        if (!client.expect("@#,E,x\n", std::chrono::seconds(1))) ++unanswered;
        trips.push_back(Seconds(SteadyClock::now() - asked).count() * 1000);
    }
    const Seconds wall = SteadyClock::now() - start;
    const Seconds used = sim.process().processor_time() - before;
    const auto last = reset_all(sim, boards);
    sim.control({"list"});

    double pace = 1e9;
    const auto log = sim.process().output();
    for (int i = 0; i < boards; ++i) {
        const auto times = reset_times(log, "b" + std::to_string(i));
        if (times.size() < 2) continue;
        const auto n = static_cast<std::size_t>(i);
        pace = std::min(pace, (times.back() - times.front()) / Seconds(last[n] - first[n]).count());
    }
    std::sort(trips.begin(), trips.end());
    const std::regex behind("behind milliseconds");
    return {used.count() / wall.count(),
            pace,
            trips[trips.size() / 2],
            trips[trips.size() * 99 / 100],
            static_cast<int>(std::distance(std::sregex_iterator(log.begin(), log.end(), behind), {})),
            unanswered};
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<int> counts = {1, 4, 10, 16};
    if (argc > 1) counts = {std::atoi(argv[1])};
    fmt::print("boards  cores used  simulated/wall  round trip p50    p99  fell behind  unanswered\n");
    bool kept_up = true;
    for (const int boards : counts) {
        const auto m = measure(boards);
        fmt::print("{:6}  {:10.2f}  {:14.4f}  {:11.2f} ms  {:5.2f}  {:11}  {:10}\n", boards, m.processors,
                   m.pace, m.median_ms, m.p99_ms, m.behind, m.unanswered);
        std::fflush(stdout);
        if (boards == 10 && (m.pace < 0.99 || m.unanswered > 0)) kept_up = false;
    }
    if (!kept_up) fmt::print("ten boards did not keep up with real time on this machine\n");
    return kept_up ? 0 : 1;
}
