// SPDX-License-Identifier: Apache-2.0
// asip-registry beside a real broker: cold start on 100,000 retained boards, and how long a change takes to
// its watchers.
#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstdio>
#include <functional>
#include <vector>

#include "asip/mqtt/client.hpp"
#include "bench/retained_boards.hpp"
#include "tests/support/child_process.hpp"

namespace asip {
namespace {

using bench::BoardTexts;
using bench::description;
using bench::options_for;
using test::ChildProcess;

constexpr std::uint32_t kBoards = 100'000;

double seconds_since(Time start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}
double percentile(std::vector<double> values, std::size_t percent) {
    std::sort(values.begin(), values.end());
    return values[values.size() * percent / 100];
}

double registry_start(const test::MosquittoBroker& broker) {
    const Time start = Clock::now();
    ChildProcess registry({ASIP_REGISTRY_PROGRAM, "--broker", broker.address(), "--id", "bench"});
    const auto line =
        registry.wait_for_errors("catalogue is complete  boards=100000", std::chrono::seconds(60));
    const double seconds = seconds_since(start);
    if (!line) std::fprintf(stderr, "the registry did not get all boards:\n%s", registry.errors().c_str());
    registry.signal(15);
    registry.wait_exit();
    return line ? seconds : 1e9;
}

double plain_subscriber(const test::MosquittoBroker& broker) {
    const Time start = Clock::now();
    // Through a shell, so that what it prints goes nowhere: reading the output is not part of the comparison.
    ChildProcess subscriber({"sh", "-c",
                             "exec mosquitto_sub -V 5 -p " + std::to_string(broker.port()) +
                                 " -t 'asip/servicebus/#' -C 100000 >/dev/null"});
    subscriber.wait_exit(std::chrono::seconds(60));
    return seconds_since(start);
}

/// Publishes, one after the other, and times how long until `topic` answers.
std::vector<double> round_trips(const test::MosquittoBroker& broker, const std::string& topic, int count,
                                const std::function<mqtt::Message(int)>& next) {
    boost::asio::io_context io;
    std::vector<double> micros;
    Time sent;
    int number = 0;
    mqtt::Client* client = nullptr;
    const auto send = [&] {
        sent = Clock::now();
        client->publish(next(++number), mqtt::Priority::kAnnouncement);
    };
    mqtt::Client::Handlers handlers;
    handlers.on_connected = [&](const mqtt::Connected&) { send(); };
    handlers.on_message = [&](const mqtt::Message& message) {
        if (message.topic != topic) return;
        micros.push_back(seconds_since(sent) * 1e6);
        if (number == count) return io.stop();
        send();
    };
    mqtt::Client round(io, options_for(broker), handlers);
    client = &round;
    round.subscribe(topic);
    round.start();
    io.run_for(std::chrono::seconds(60));
    return micros;
}

void cold_start() {
    test::MosquittoBroker broker(test::MosquittoBroker::Options{.extra_lines = {"max_queued_messages 0"}});
    bench::retain_boards(broker, kBoards);
    std::vector<double> ours;
    std::vector<double> plain;
    for (int i = 0; i < 5; ++i) {
        plain.push_back(plain_subscriber(broker));
        ours.push_back(registry_start(broker));
    }
    std::printf("%-66s %12.3f s\n", "cold start on 100,000 retained boards, 5 services each", median(ours));
    std::printf("%-66s %12.3f s\n", "  mosquitto_sub reading the same", median(plain));
    std::printf("%-66s %12.3f x       must 1.5       aim 1.1\n", "  ratio", median(ours) / median(plain));
}

void announcement_to_event() {
    constexpr int kCount = 3000;
    test::MosquittoBroker broker;
    ChildProcess registry({ASIP_REGISTRY_PROGRAM, "--broker", broker.address(), "--id", "bench"});
    if (!registry.wait_for_errors("catalogue is complete")) return;
    const auto change = round_trips(broker, "asip/registry/bench/events", kCount, [](int i) {
        mqtt::Message message = description(1, static_cast<std::uint64_t>(i));
        message.qos = 0;
        const auto place = message.payload.find("\"Sketch");
        message.payload.replace(place, 7, "\"Sketch" + std::to_string(i) + "-");
        return message;
    });
    const auto echo = round_trips(broker, "bench/echo", kCount, [](int i) {
        mqtt::Message message;
        message.topic = "bench/echo";
        message.payload = BoardTexts().description(1, static_cast<std::uint64_t>(i));
        return message;
    });
    if (change.size() < kCount || echo.size() < kCount) {
        std::printf("announcement to change event: only %zu of %d came\n", change.size(), kCount);
        return;
    }
    std::printf("%-66s %12.1f us    p50 %.1f us\n", "announcement to change event at a watcher, p99",
                percentile(change, 99), percentile(change, 50));
    std::printf("%-66s %12.1f us    p50 %.1f us\n", "  broker round trip of the same bytes, p99",
                percentile(echo, 99), percentile(echo, 50));
    std::printf("%-66s %12.3f x       must 1.8       aim 1.4   (p50 %.2f x)\n", "  ratio of p99",
                percentile(change, 99) / percentile(echo, 99), percentile(change, 50) / percentile(echo, 50));
    registry.signal(15);
    registry.wait_exit();
}

}  // namespace
}  // namespace asip

int main() {
    asip::cold_start();
    asip::announcement_to_event();
}
