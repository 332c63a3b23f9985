// SPDX-License-Identifier: Apache-2.0
// asip-agent under attack: what a flood costs a polite client, and what hostile input costs the agent.
// Simulated boards with real firmware, a real Mosquitto, the agent as it is shipped.
#include <arpa/inet.h>
#include <fcntl.h>
#include <pty.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "bench/figures.hpp"
#include "bench/mqtt_client.hpp"
#include "tests/integration/agent/rig.hpp"
#include "tests/support/temp_dir.hpp"

namespace {

using namespace asip::test;
using namespace asip::bench;
using namespace std::chrono_literals;

constexpr int kLinesPerSecond = 3000;
constexpr std::size_t kPayload = 100'000'000;
constexpr int kConnections = 1000;
constexpr int kGarbageBytesPerSecond = 100'000;  // 1 Mbit/s with start and stop bits

/// The agent with the log level that it has by itself.
class QuietAgent {
  public:
    QuietAgent(const MosquittoBroker& broker, const std::string& port, std::vector<std::string> more = {}) {
        std::vector<std::string> command{
            ASIP_PROGRAMS "/asip-agent", "--serial", port, "--broker", broker.url(), "--name", "uno1"};
        command.insert(command.end(), more.begin(), more.end());
        process_ = std::make_unique<ChildProcess>(std::move(command));
    }
    ChildProcess& process() { return *process_; }

  private:
    std::unique_ptr<ChildProcess> process_;
};

void wait_online(const MosquittoBroker& broker, QuietAgent& agent) {
    BusProbe probe(broker.port());
    if (!wait_state(probe, "online")) throw std::runtime_error(agent.process().errors());
}

/// Runs `once` in a thread each millisecond until it is destroyed.
class EachMillisecond {
  public:
    explicit EachMillisecond(std::function<void()> once)
        : thread_([this, once = std::move(once)] {
              auto due = Clock::now();
              while (!stop_) {
                  once();
                  std::this_thread::sleep_until(due += 1ms);
              }
          }) {}
    ~EachMillisecond() {
        stop_ = true;
        thread_.join();
    }

  private:
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

int connect_to(std::uint16_t port) {
    const int fd = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (fd < 0 || connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
        throw std::runtime_error("no connection to the agent's port");
    fcntl(fd, F_SETFL, O_NONBLOCK);
    return fd;
}

/// A command, its answer, a pause; `refused` counts answers other than ok.
Latency polite(MqttClient& client, int& refused) {
    constexpr int kRounds = 300;
    std::vector<double> samples;
    for (int round = 0; round < kRounds; ++round) {
        client.take();
        const std::string id = std::to_string(round);
        const auto start = Clock::now();
        client.publish("asip/uno1/io/in", R"({"write":[13,)" + std::to_string(round % 2) + R"(],"id":")" +
                                              id + R"(","reply_to":"bench/polite"})");
        bool done = false;
        while (!done && client.wait(6s))
            for (const auto& [topic, payload] : client.take())
                if (payload.find("\"id\":\"" + id + "\"") != std::string::npos) {
                    done = true;
                    refused += payload.find("\"ok\"") == std::string::npos;
                }
        samples.push_back(Milliseconds(Clock::now() - start).count());
        std::this_thread::sleep_for(10ms);
    }
    return summary(samples);
}

void beside_a_flood(MosquittoBroker& broker) {
    SimulatedUno uno;
    const std::uint16_t port = free_port();
    QuietAgent agent(broker, uno.port(), {"--listen", std::to_string(port)});
    wait_online(broker, agent);
    MqttClient client(broker.port());
    client.subscribe("bench/polite");
    int refused = 0;
    polite(client, refused);  // the board's line has stepped up, everything is warm
    refused = 0;
    const Latency alone = polite(client, refused);
    const auto compare = [&](const char* what, const Latency& flooded) {
        std::printf("%s: answer p50 %.2f p99 %.2f ms; without a flood p50 %.2f p99 %.2f ms; refused %d\n",
                    what, flooded.p50, flooded.p99, alone.p50, alone.p99, refused);
        row(std::string("p99 of a polite client's answers beside ") + what + ", over without",
            flooded.p99 / alone.p99, "x", 3, 2);
    };
    {
        MqttClient flooder(broker.port());
        EachMillisecond flood([&] {
            for (int i = 0; i < kLinesPerSecond / 1000; ++i)
                flooder.publish("asip/uno1/in", i % 2 ? "I,d,12,1" : "I,d,12,0");
            flooder.wait(0ms);
        });
        compare("3,000 lines/s over MQTT", polite(client, refused));
    }
    std::this_thread::sleep_for(1s);
    {
        const int fd = connect_to(port);
        EachMillisecond flood([&] {
            std::string lines;
            for (int i = 0; i < kLinesPerSecond / 1000; ++i)
                lines += i % 2 ? "I,d,12,1\n" : "I,d,12,0\n";
            [[maybe_unused]] const auto sent = write(fd, lines.data(), lines.size());  // it is read more
                                                                                       // slowly
            char buffer[4096];
            while (read(fd, buffer, sizeof buffer) > 0) {
            }
        });
        compare("3,000 lines/s over TCP", polite(client, refused));
        close(fd);
    }
}

/// Largest memory, and processor time over real time, of the agent for `time`.
void watch(QuietAgent& agent, const std::string& what, std::chrono::seconds time) {
    std::size_t memory = 0;
    const auto before = agent.process().processor_time();
    const auto start = Clock::now();
    while (Clock::now() - start < time) {
        memory = std::max(memory, agent.process().resident_bytes());
        std::this_thread::sleep_for(20ms);
    }
    const double busy =
        Milliseconds(agent.process().processor_time() - before) / Milliseconds(Clock::now() - start);
    if (!agent.process().running()) throw std::runtime_error("the agent ended: " + agent.process().errors());
    row(what + ": memory of the agent", double(memory) / (1 << 20), "MB", 20, 10);
    row(what + ": processor", busy * 100, "% core", 10, 5);
}

void huge_payload(MosquittoBroker& broker) {
    SimulatedUno uno;
    QuietAgent agent(broker, uno.port());
    wait_online(broker, agent);
    std::thread sender([&] {
        MqttClient client(broker.port());
        client.publish("asip/uno1/io/in", std::string(kPayload, '['), 1);
        client.spin(9s);
    });
    watch(agent, "a payload of 100 MB", 10s);
    sender.join();
}

void many_connections(MosquittoBroker& broker) {
    SimulatedUno uno;
    const std::uint16_t port = free_port();
    QuietAgent agent(broker, uno.port(), {"--listen", std::to_string(port)});
    wait_online(broker, agent);
    std::vector<int> sockets;
    std::thread opener([&] {
        for (int i = 0; i < kConnections; ++i)
            sockets.push_back(connect_to(port));
    });
    watch(agent, "1,000 connections", 10s);
    opener.join();
    for (const int fd : sockets)
        close(fd);
}

void garbage(MosquittoBroker& broker) {
    int master = -1, slave = -1;
    char path[256] = {};
    if (openpty(&master, &slave, path, nullptr, nullptr) != 0) throw std::runtime_error("no pseudo-terminal");
    fcntl(master, F_SETFL, O_NONBLOCK);
    QuietAgent agent(broker, path, {"--patience", "60"});  // or it would end: that is no board
    unsigned random = 1;
    EachMillisecond noise([&] {
        char bytes[kGarbageBytesPerSecond / 1000];
        for (char& byte : bytes)
            byte = static_cast<char>((random = random * 1664525 + 1013904223) >> 24);
        [[maybe_unused]] const auto sent = write(master, bytes, sizeof bytes);
        char back[4096];
        while (read(master, back, sizeof back) > 0) {
        }
    });
    watch(agent, "garbage at 1 Mbit/s", 15s);
    close(slave);
}

}  // namespace

int main() {
    mosquitto_lib_init();
    try {
        MosquittoBroker broker({.extra_lines = {"max_queued_messages 0"}});
        beside_a_flood(broker);
        huge_payload(broker);
        many_connections(broker);
        garbage(broker);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_agent_attack: %s\n", error.what());
        return 1;
    }
}
