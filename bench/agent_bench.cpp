// SPDX-License-Identifier: Apache-2.0
// The figures of asip-agent, each beside what it is compared with, measured in the same run: simulated boards
// with real firmware, a real Mosquitto, the agent as it is shipped.
//   bench_agent [OPTION OF asip-agent ...]
#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "asip/link/baud.hpp"
#include "bench/figures.hpp"
#include "bench/mqtt_client.hpp"
#include "tests/integration/agent/rig.hpp"

namespace {

using namespace asip::test;
using namespace asip::bench;

constexpr int kRounds = 400;

std::string command(int round) {
    return round % 2 ? "I,d,13,1" : "I,d,13,0";
}
bool is_event(std::string_view line) {
    return line.starts_with("@I,d,2,");
}

/// Command to event on the serial port itself.
Latency direct(const std::string& port, int baud) {
    const int fd = open(port.c_str(), O_RDWR | O_NOCTTY);
    if (fd < 0) throw std::runtime_error("cannot open " + port);
    termios settings{};
    tcgetattr(fd, &settings);
    cfmakeraw(&settings);
    tcsetattr(fd, TCSANOW, &settings);
    asip::link::set_terminal_baud(fd, baud);
    std::string pending;
    const auto line = [&](std::chrono::milliseconds limit) -> std::string {
        const auto end = Clock::now() + limit;
        while (Clock::now() < end) {
            if (const auto at = pending.find('\n'); at != std::string::npos) {
                std::string text = pending.substr(0, at);
                pending.erase(0, at + 1);
                return text;
            }
            pollfd poll_for{fd, POLLIN, 0};
            char buffer[512];
            if (poll(&poll_for, 1, 10) > 0)
                if (const auto count = read(fd, buffer, sizeof buffer); count > 0)
                    pending.append(buffer, size_t(count));
        }
        return {};
    };
    // An agent that was killed left its checksums on; a board without them answers with an error.
    for (const char* setup : {"#,C,0*50\n", "\n", "I,A,0\n", "I,P,13,3\n", "I,P,12,1\n"}) {
        if (write(fd, setup, strlen(setup)) < 0) break;
        // For a while, not until it is silent: it reports its analog inputs until that is turned off.
        const auto settled = Clock::now() + std::chrono::milliseconds(100);
        while (Clock::now() < settled)
            line(std::chrono::milliseconds(10));
    }
    std::vector<double> samples;
    for (int round = 0; round < kRounds; ++round) {
        const auto start = Clock::now();
        const std::string text = command(round + 1) + "\n";
        if (write(fd, text.data(), text.size()) < 0) break;
        std::string answer;
        do
            answer = line(std::chrono::milliseconds(500));
        while (!answer.empty() && !is_event(answer));
        if (!answer.empty()) samples.push_back(Milliseconds(Clock::now() - start).count());
        usleep(3000 + (round * 331) % 2000);
    }
    close(fd);
    return summary(samples);
}

/// Command on asip/B/in to event on asip/B/out.
Latency bridged(MqttClient& client) {
    for (const char* setup : {"I,A,0", "I,P,13,3", "I,P,12,1"}) {
        client.publish("asip/uno1/in", setup);
        client.spin(std::chrono::milliseconds(200));
    }
    std::vector<double> samples;
    for (int round = 0; round < kRounds; ++round) {
        client.take();
        const auto start = Clock::now();
        client.publish("asip/uno1/in", command(round + 1));
        bool done = false;
        while (!done && client.wait(std::chrono::milliseconds(500)))
            for (const auto& [topic, payload] : client.take())
                done = done || is_event(payload);
        if (done) samples.push_back(Milliseconds(Clock::now() - start).count());
        usleep(3000 + (round * 331) % 2000);
    }
    return summary(samples);
}

Latency broker_round_trip(MqttClient& client) {
    client.subscribe("bench/echo");
    std::vector<double> samples;
    for (int round = 0; round < kRounds * 2; ++round) {
        const auto start = Clock::now();
        client.publish("bench/echo", "I,d,13,1");
        if (client.wait(std::chrono::milliseconds(500)))
            samples.push_back(Milliseconds(Clock::now() - start).count());
        client.take();
        usleep(500);
    }
    return summary(samples);
}

double acknowledged_per_second(MqttClient& client) {
    client.subscribe("bench/answers");
    constexpr int kCommands = 10000;
    constexpr int kWindow = 60;  // of one client at most 64 wait
    int sent = 0, answered = 0, ok = 0;
    const auto start = Clock::now();
    while (answered < kCommands && Clock::now() - start < std::chrono::seconds(30)) {
        while (sent < kCommands && sent - answered < kWindow) {
            client.publish("asip/uno1/io/in", R"({"write":[13,)" + std::to_string(sent % 2) + R"(],"id":")" +
                                                  std::to_string(sent) + R"(","reply_to":"bench/answers"})");
            ++sent;
        }
        if (!client.wait(std::chrono::milliseconds(200))) continue;
        for (const auto& [topic, payload] : client.take()) {
            if (topic != "bench/answers") continue;
            ++answered;
            if (payload.find("\"ok\"") != std::string::npos) ++ok;
        }
    }
    return ok / std::chrono::duration<double>(Clock::now() - start).count();
}

void wait_online(const MosquittoBroker& broker, Agent& agent) {
    BusProbe probe(broker.port());
    if (!wait_state(probe, "online")) throw std::runtime_error(agent.process().errors());
}

void plain_board(MosquittoBroker& broker, const std::vector<std::string>& more) {
    SimulatedUno uno("asip_uno_04_services");
    const Latency wire = direct(uno.port(), 57600);
    Agent agent(broker, uno.port(), more);
    wait_online(broker, agent);
    MqttClient client(broker.port());
    client.subscribe("asip/uno1/out");
    const Latency bus = bridged(client);
    std::printf("0.4 board at 57600: serial port p50 %.3f p99 %.3f ms; over the bus p50 %.3f p99 %.3f ms\n",
                wire.p50, wire.p99, bus.p50, bus.p99);
    row("0.4 board at 57600, command to event, p50, over the serial port's", bus.p50 / wire.p50, "x", 1.08,
        1.04);
    row("  its p99 over the serial port's", bus.p99 / wire.p99, "x", 1.6, 1.2);
}

void fast_board(MosquittoBroker& broker, const std::vector<std::string>& more) {
    SimulatedUno uno;
    int baud = 0;
    Latency bus, echo;
    {
        Agent agent(broker, uno.port(), more);
        wait_online(broker, agent);
        const auto line = agent.process().wait_for_errors("board identified");
        baud = std::stoi(line->substr(line->rfind("baud=") + 5));
        MqttClient client(broker.port());
        client.subscribe("asip/uno1/out");
        bus = bridged(client);
        MqttClient other(broker.port());
        echo = broker_round_trip(other);
        row("commands acknowledged per second, line stepped up", acknowledged_per_second(other), "1/s", 3000,
            3500, true);
        agent.kill();
    }
    const Latency wire = direct(uno.port(), baud);
    std::printf(
        "stepped up to %d: serial port p50 %.3f p99 %.3f; broker p50 %.3f; over the bus p50 %.3f p99 %.3f "
        "ms\n",
        baud, wire.p50, wire.p99, echo.p50, bus.p50, bus.p99);
    row("line stepped up, command to event, p50, over broker plus wire", bus.p50 / (echo.p50 + wire.p50), "x",
        1.6, 1.2);
    row("  its p99 over the serial port's", bus.p99 / wire.p99, "x", 1.6, 1.2);
}

void idle_board(MosquittoBroker& broker, const std::vector<std::string>& more) {
    SimulatedUno uno;
    Agent agent(broker, uno.port(), more);
    wait_online(broker, agent);
    const auto before = agent.process().processor_time();
    const auto start = Clock::now();
    std::this_thread::sleep_for(std::chrono::seconds(10));
    const double busy =
        Milliseconds(agent.process().processor_time() - before) / Milliseconds(Clock::now() - start);
    row("memory of one agent", double(agent.process().resident_bytes()) / (1 << 20), "MB", 20, 10);
    row("processor, idle board with 50 ms analog events", busy * 100, "% core", 2, 1);
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> more(argv + 1, argv + argc);
    mosquitto_lib_init();
    try {
        MosquittoBroker broker({.extra_lines = {"max_queued_messages 0"}});
        plain_board(broker, more);
        fast_board(broker, more);
        idle_board(broker, more);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_agent: %s\n", error.what());
        return 1;
    }
}
