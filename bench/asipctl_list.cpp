// SPDX-License-Identifier: Apache-2.0
// `asipctl list` against a registry with 1,000 boards of five services each, as a whole process, beside
// `mosquitto_sub -C 1` on the same broker.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/support/bus_probe.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/mosquitto_broker.hpp"

namespace {

using namespace asip::test;

constexpr int kBoards = 1000;
constexpr int kRuns = 41;

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

/// Milliseconds of one whole process; negative: it failed.
double once(const std::vector<std::string>& command) {
    std::string line;
    for (const auto& word : command)
        line += "'" + word + "' ";
    line += ">/dev/null";
    const auto begin = std::chrono::steady_clock::now();
    if (std::system(line.c_str()) != 0) return -1;
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

/// Median milliseconds of each command. They take turns, so that what else the machine does meets all alike.
std::vector<double> medians_of(const std::vector<std::vector<std::string>>& commands) {
    std::vector<std::vector<double>> milliseconds(commands.size());
    for (int run = 0; run < kRuns; ++run) {
        for (std::size_t i = 0; i < commands.size(); ++i)
            milliseconds[i].push_back(once(commands[i]));
    }
    std::vector<double> medians;
    for (auto& runs : milliseconds) {
        std::nth_element(runs.begin(), runs.begin() + kRuns / 2, runs.end());
        const bool failed = std::any_of(runs.begin(), runs.end(), [](double ms) { return ms < 0; });
        medians.push_back(failed ? -1 : runs[kRuns / 2]);
    }
    return medians;
}

}  // namespace

int main() {
    MosquittoBroker broker;
    BusProbe probe(broker.port(), {"asip/registry/#"});
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
    const auto medians =
        medians_of({{"mosquitto_sub", "-p", port, "-t", "asip/servicebus/+/$state", "-C", "1"},
                    {"mosquitto_sub", "-p", port, "-t", "asip/servicebus/+/$description", "-C", "1000"},
                    asipctl({"list"}),
                    asipctl({"list", "-o", "jsonl"}),
                    asipctl({"list", "--board", "board7", "-o", "name"})});
    const double sub = medians[0];
    const double all = medians[1];
    const double list = medians[2];
    const double whole = medians[3];
    const double name = medians[4];
    std::printf("median of %d runs, whole process                       ms     beside mosquitto_sub -C 1\n",
                kRuns);
    std::printf("mosquitto_sub -C 1                               %8.2f\n", sub);
    std::printf("mosquitto_sub -C 1000 (all descriptions)         %8.2f   %6.2f\n", all, all / sub);
    std::printf("asipctl list of 1,000 boards                     %8.2f   %6.2f  (must 3, aim 1.5)\n", list,
                list / sub);
    std::printf(
        "asipctl list -o jsonl of them (all that is known)%8.2f   %6.2f  (%.2f of all descriptions, must "
        "2)\n",
        whole, whole / sub, whole / all);
    std::printf("asipctl list of one board out of 1,000           %8.2f   %6.2f\n", name, name / sub);
    return sub > 0 && list > 0 ? 0 : 1;
}
