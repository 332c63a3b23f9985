// SPDX-License-Identifier: Apache-2.0
// `asipctl record` while boards say 5,000 messages a second: what it loses, and what it costs, beside
// `mosquitto_sub` that writes the same messages to a file.
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "bench/figures.hpp"
#include "bench/mqtt_client.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/mosquitto_broker.hpp"
#include "tests/support/temp_dir.hpp"

namespace {

using namespace asip::test;
using asip::bench::Clock;

constexpr int kRate = 5000;
constexpr int kSeconds = 10;
constexpr int kBoards = 50;

std::size_t lines_with(const std::string& path, const std::string& word) {
    std::ifstream file(path);
    std::size_t count = 0;
    for (std::string line; std::getline(file, line);)
        count += line.find(word) != std::string::npos ? 1 : 0;
    return count;
}

/// Values and raw lines in turn, as agents publish them.
void say(asip::bench::MqttClient& boards, int number) {
    const auto board = "asip/uno" + std::to_string(number / 2 % kBoards);
    const auto value = std::to_string(number);
    if (number % 2 == 0) {
        boards.publish(board + "/distance/out", R"({"distance":[)" + value + ",118]}");
    } else {
        boards.publish(board + "/out", "@D,e,2,{" + value + ",118}");
    }
}

/// The rate is kept by the clock: a thousandth of a second that came late is made up for.
void say_all(asip::bench::MqttClient& boards) {
    const auto begin = Clock::now();
    for (int said = 0; said < kRate * kSeconds;) {
        const auto passed = std::chrono::duration<double>(Clock::now() - begin).count();
        for (const int due = std::min(static_cast<int>(passed * kRate), kRate * kSeconds); said < due; ++said)
            say(boards, said);
        boards.wait(std::chrono::milliseconds(1));
        boards.take();
    }
    boards.spin(std::chrono::milliseconds(500));
}

}  // namespace

int main() {
    const TempDir folder;
    const auto path = folder.file("load.jsonl");
    MosquittoBroker broker;
    asip::bench::MqttClient boards(broker.port());
    ChildProcess record({ASIP_PROGRAMS "/asipctl", "record", path, "--broker", broker.address()});
    // It records once it records the first message.
    if (!wait_until([&] {
            boards.publish("asip/uno0/first/out", "{}");
            boards.spin(std::chrono::milliseconds(20));
            return lines_with(path, "\"first\"") > 0;
        }))
        return 1;
    ChildProcess sub({"sh", "-c",
                      "exec mosquitto_sub -p " + std::to_string(broker.port()) +
                          " -F '%I %t %p' -t 'asip/#' >" + folder.file("sub.txt")});
    if (!wait_until([&] {
            boards.publish("asip/uno0/second/out", "{}");
            boards.spin(std::chrono::milliseconds(20));
            return std::filesystem::exists(folder.file("sub.txt")) && sub.processor_time().count() > 0;
        }))
        return 1;
    const auto before = record.processor_time();
    const auto sub_before = sub.processor_time();
    say_all(boards);
    const auto used = record.processor_time() - before;
    const auto sub_used = sub.processor_time() - sub_before;
    record.signal(SIGINT);
    record.wait_exit();
    const auto recorded = lines_with(path, ",118");  // no time has a comma
    const auto percent_of = [](std::chrono::milliseconds time) {
        return static_cast<double>(time.count()) / (kSeconds * 1000.0) * 100 / (kRate / 1000.0);
    };
    const double percent = percent_of(used);
    std::printf("%d messages a second for %d s, of %d boards: %zu recorded, %zu bytes\n", kRate, kSeconds,
                kBoards, recorded, static_cast<std::size_t>(std::filesystem::file_size(path)));
    asip::bench::row("record: messages that are missing", kRate * kSeconds - static_cast<double>(recorded),
                     "", 0, 0);
    asip::bench::row("record: of one core, for 1,000 messages a second", percent, "%", 3, 3);
    std::printf(
        "mosquitto_sub beside it, which writes topic and payload: %.2f %% for 1,000 messages a second\n",
        percent_of(sub_used));
    return recorded == kRate * kSeconds ? 0 : 1;
}
