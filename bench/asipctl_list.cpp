// SPDX-License-Identifier: Apache-2.0
// `asipctl list` against a registry with 1,000 boards of five services each, as a whole process, beside
// `mosquitto_sub -C 1` on the same broker.
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <tuple>
#include <vector>

#include "bench/figures.hpp"
#include "tests/support/bus_probe.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/mosquitto_broker.hpp"

namespace {

using namespace asip::test;

constexpr int kBoards = 1000;
constexpr int kRuns = 50;
constexpr int kMayFail = 5;  // mosquitto_sub 2.0.11 sometimes misses what is retained, and would wait for
                             // ever

std::string description(const std::string& board) {
    return R"({"board":")" + board +
           R"(","session":"5f3a9c01","seq":3,"lease":3600,"firmware":{"protocol":"0.4","chip":"ATmega328P","sketch":"AsipHello"},)"
           R"("link":{"kind":"serial","path":"/dev/ttyACM0","baud":500000},"agent":{"version":"0.1.0","host":"pi","client":"asip-agent-1"},)"
           R"("pins":{"capabilities":"11151511515511333333","owners":"@@IIIIIIISDIIIIIIIII","modes":"66111111177111444444"},)"
           R"("services":[{"name":"io","id":"I","model":"io@1","title":"ASIP core IO"},)"
           R"({"name":"distance","id":"D","model":"distance@1","title":"Distance","count":2,"period":100},)"
           R"({"name":"servo","id":"S","model":"servo@1","title":"Servos","count":1},)"
           R"({"name":"tone","id":"T","model":"tone@1","title":"Tone"},{"name":"bump","id":"B","model":"bump@1","title":"Bump"}]})";
}

/// Milliseconds of one whole process, without a shell around it; negative: it failed.
double once(const std::vector<std::string>& command) {
    std::vector<char*> words;
    for (const auto& word : command)
        words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    const auto begin = std::chrono::steady_clock::now();
    pid_t process = 0;
    int status = -1;
    const bool started = posix_spawnp(&process, words[0], &actions, nullptr, words.data(), environ) == 0;
    if (started) waitpid(process, &status, 0);
    const auto end = std::chrono::steady_clock::now();
    posix_spawn_file_actions_destroy(&actions);
    return status == 0 ? std::chrono::duration<double, std::milli>(end - begin).count() : -1;
}

struct Times {
    double minimum = 0, median = 0;  ///< milliseconds; negative: more than a few runs failed
};

/// They take turns, so that what else the machine does meets all alike.
std::vector<Times> times_of(const std::vector<std::vector<std::string>>& commands) {
    std::vector<std::vector<double>> milliseconds(commands.size());
    for (int run = 0; run < kRuns; ++run)
        for (std::size_t i = 0; i < commands.size(); ++i)
            milliseconds[i].push_back(once(commands[i]));
    std::vector<Times> times;
    for (std::size_t i = 0; i < commands.size(); ++i) {
        auto& runs = milliseconds[i];
        const auto failed = static_cast<int>(std::erase_if(runs, [](double time) { return time < 0; }));
        if (failed != 0)
            std::printf("%s failed or waited for nothing in %d runs\n", commands[i][0].c_str(), failed);
        std::sort(runs.begin(), runs.end());
        times.push_back(failed > kMayFail ? Times{-1, -1} : Times{runs.front(), runs[runs.size() / 2]});
    }
    return times;
}

void print(const char* what, const Times& times) {
    std::printf("%-64s %8.2f %8.2f\n", what, times.minimum, times.median);
}

}  // namespace

int main() {
    MosquittoBroker broker;
    BusProbe probe(broker.port(), std::vector<std::string>{});
    for (int i = 0; i < kBoards; ++i) {
        const auto board = "board" + std::to_string(i);
        probe.publish("asip/servicebus/" + board + "/$description", description(board), true);
        probe.publish("asip/servicebus/" + board + "/$state", "online", true);
    }
    if (!wait_until([&] { return probe.all_acknowledged(); })) return 1;
    ChildProcess registry({ASIP_PROGRAMS "/asip-registry", "--broker", broker.address(), "--id", "bench"});
    if (!registry.wait_for_errors("catalogue is complete")) return 1;
    const auto port = std::to_string(broker.port());
    const auto asipctl = [&](const std::vector<std::string>& words) {
        std::vector<std::string> command{ASIP_PROGRAMS "/asipctl", "--broker", broker.address()};
        command.insert(command.end(), words.begin(), words.end());
        return command;
    };
    // Behind what moves a megabyte the broker has still to clean up: the first two come behind a short one.
    const auto times = times_of(
        {{"mosquitto_sub", "-p", port, "-t", "asip/servicebus/+/$state", "-C", "1", "-W", "5"},
         asipctl({"list"}),
         asipctl({"--version"}),
         {"mosquitto_sub", "-p", port, "-t", "asip/servicebus/+/$description", "-C", "1000", "-W", "5"},
         asipctl({"list", "-o", "jsonl"}),
         asipctl({"list", "--board", "board7", "-o", "name"})});
    const auto& [sub, list, version, all, whole, single] =
        std::tie(times[0], times[1], times[2], times[3], times[4], times[5]);
    std::printf("%-64s %8s %8s\n", "whole process, milliseconds", "minimum", "median");
    print("mosquitto_sub -C 1", sub);
    print("mosquitto_sub -C 1000, all descriptions", all);
    print("asipctl list of 1,000 boards", list);
    print("asipctl list -o jsonl of them, all that is known", whole);
    print("asipctl list of one board out of 1,000", single);
    print("asipctl --version", version);
    asip::bench::row("asipctl list beside mosquitto_sub -C 1, minima", list.minimum / sub.minimum, "times",
                     1.35, 1.15);
    asip::bench::row("asipctl list beside mosquitto_sub -C 1, medians", list.median / sub.median, "times",
                     1.35, 1.15);
    asip::bench::row("asipctl list -o jsonl beside mosquitto_sub of all, minima", whole.minimum / all.minimum,
                     "times", 2, 2);
    asip::bench::row("asipctl list -o jsonl beside mosquitto_sub of all, medians", whole.median / all.median,
                     "times", 2, 2);
    const bool measured =
        std::all_of(times.begin(), times.end(), [](const Times& one) { return one.minimum > 0; });
    return measured ? 0 : 1;
}
