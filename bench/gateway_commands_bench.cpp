// SPDX-License-Identifier: Apache-2.0
// Commands, values and stops through asip-gateway, beside the same over MQTT: a real board in the simulator,
// its agent, the broker.
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "bench/figures.hpp"
#include "bench/http_load.hpp"
#include "bench/mqtt_client.hpp"
#include "tests/integration/agent/rig.hpp"
#include "tests/integration/gateway/running_gateway.hpp"

namespace {

using namespace asip::bench;
using namespace asip::test;

constexpr int kRounds = 300;
constexpr int kWarmUp = 300;  // not counted: a board and its agent that have just come up are slower
constexpr int kTurns = 10;    // of each of two that are measured in turn
constexpr int kStops = 40;
constexpr int kQueued = 10'000;

/// asip-sim with one Uno named "uno".
class Uno {
  public:
    Uno(const std::string& image, const std::string& parts) : port_(folder_.file("uno")) {
        const auto file =
            folder_.write("uno.json", R"({"name":"uno","board":"uno","image":")" ASIP_IMAGES "/" + image +
                                          R"(.elf","link":")" + port_ + R"(","parts":[)" + parts + "]}");
        process_ = std::make_unique<ChildProcess>(
            std::vector<std::string>{ASIP_PROGRAMS "/asip-sim", file, "--no-socket"});
        if (!process_->wait_for_output(" port ")) throw std::runtime_error("asip-sim: " + process_->errors());
    }
    const std::string& port() const { return port_; }
    void command(const std::string& line) { process_->write_input(line + "\n"); }

  private:
    TempDir folder_;
    std::string port_;
    std::unique_ptr<ChildProcess> process_;
};

struct Bus {
    // As packaged: no line of a log for each message.
    MosquittoBroker broker{{.extra_lines = {"max_queued_messages 0", "log_type none"}}};
    RunningGateway gateway{broker.address(), {"--config", settings_file("commands-per-second = 100000\n")}};

    void wait_online(Agent& agent) {
        // A simulated board that shares its processor with others may need several attempts at a line rate.
        bool online = gateway.ready() && gateway.becomes("uno1", "online");
        for (int attempt = 0; attempt < 4 && !online; ++attempt)
            online = gateway.becomes("uno1", "online");
        if (!online) throw std::runtime_error(agent.process().errors());
    }
};

/// Until a message contains `text`.
double wait_for(MqttClient& client, const std::string& text, Clock::time_point begin) {
    const auto end = begin + std::chrono::seconds(10);
    while (Clock::now() < end) {
        client.wait(std::chrono::milliseconds(100));
        for (const auto& [topic, payload] : client.take())
            if (payload.find(text) != std::string::npos) return Milliseconds(Clock::now() - begin).count();
    }
    throw std::runtime_error("nothing with " + text);
}

void commands(Bus& bus) {
    MqttClient client(bus.broker.port());
    client.subscribe("bench/answers", 1);  // as the client library and the gateway do
    HttpConnection http(bus.gateway.port());
    std::vector<double> ours, theirs;
    const auto by_http = [&](const std::string& level) {
        const auto request =
            http_request("POST", "/api/boards/uno1/services/io/commands/write", "[13," + level + "]");
        const auto begin = Clock::now();
        if (http.ask(request).empty()) throw std::runtime_error("a command failed");
        ours.push_back(Milliseconds(Clock::now() - begin).count());
    };
    const auto by_mqtt = [&](const std::string& level, const std::string& id) {
        const auto begin = Clock::now();
        client.publish("asip/uno1/io/in",
                       R"({"write":[13,)" + level + R"(],"deadline_ms":5000,"id":")" + id +
                           R"(","reply_to":"bench/answers"})",
                       1);
        theirs.push_back(wait_for(client, "\"ok\"", begin));
    };
    // Each after a pause of its own, and in turn: what slept is slower.
    for (int round = 0; round < 2 * (kWarmUp + kRounds); ++round) {
        if (round == 2 * kWarmUp) {
            ours.clear();
            theirs.clear();
        }
        std::this_thread::sleep_for(std::chrono::microseconds(2000 + (round * 331) % 2000));
        const std::string level = std::to_string(round / 2 % 2);
        if (round % 2 == 0)
            by_http(level);
        else
            by_mqtt(level, std::to_string(round));
    }
    std::printf("a command and its answer, p50 of %d: gateway %.3f ms, MQTT %.3f ms\n", kRounds, median(ours),
                median(theirs));
    row("POST of a command to its answer, p50, over the same by MQTT", median(ours) / median(theirs), "x",
        1.15, 1.05);
}

/// Whether a report of levels in `text` has this one of pin 2.
bool has_level(std::string_view text, bool high) {
    static constexpr std::string_view kReport = "\"digital\":{";
    for (auto at = text.find(kReport); at != text.npos; at = text.find(kReport, at + 1)) {
        const auto report = text.substr(at, text.find('}', at) - at);
        if (report.find(high ? "\"2\":1" : "\"2\":0") != report.npos) return true;
    }
    return false;
}

/// What waits for the next value of pin 2: a WebSocket of the gateway, or a subscription at the broker.
class WebReader {
  public:
    explicit WebReader(Bus& bus) : socket_(bus.gateway.port()) {
        socket_.send(R"({"subscribe":"uno1/io","ref":1})");
    }
    void pass_over(std::chrono::milliseconds time) {
        std::this_thread::sleep_for(time);
        char buffer[65536];
        while (recv(socket_.wire().socket(), buffer, sizeof buffer, MSG_DONTWAIT) > 0) {
        }
        text_.clear();
    }
    bool has(bool high) {
        pollfd polled{socket_.wire().socket(), POLLIN, 0};
        if (poll(&polled, 1, 100) <= 0) return false;
        char buffer[65536];
        const auto size = recv(polled.fd, buffer, sizeof buffer, MSG_DONTWAIT);
        if (size > 0) text_.append(buffer, std::size_t(size));
        return has_level(text_, high);
    }

  private:
    Socket socket_;
    std::string text_;
};

class BrokerReader {
  public:
    explicit BrokerReader(Bus& bus) : client_(bus.broker.port()) { client_.subscribe("asip/uno1/io/out"); }
    void pass_over(std::chrono::milliseconds time) { client_.spin(time); }
    bool has(bool high) {
        client_.wait(std::chrono::milliseconds(100));
        const auto messages = client_.take();
        return std::any_of(messages.begin(), messages.end(),
                           [&](const auto& message) { return has_level(message.second, high); });
    }

  private:
    MqttClient client_;
};

template <class Reader>
void values_for(Bus& bus, Uno& uno, std::vector<double>& samples) {
    Reader reader(bus);
    for (int round = 0; round < kRounds / kTurns; ++round) {
        reader.pass_over(std::chrono::milliseconds(20 + round % 7));
        const bool high = round % 2 != 0;
        const auto begin = Clock::now();
        uno.command(high ? "release uno/button" : "press uno/button");
        while (!reader.has(high))
            if (Clock::now() - begin > std::chrono::seconds(5))
                throw std::runtime_error("no value of the button");
        samples.push_back(Milliseconds(Clock::now() - begin).count());
    }
}

/// In turn, not both at once: a program that handles the one value keeps the other waiting.
void values(Bus& bus, Uno& uno) {
    HttpConnection http(bus.gateway.port());
    if (http.ask(http_request("POST", "/api/boards/uno1/services/io/commands/mode", R"([2,"input-pullup"])"))
            .empty())
        throw std::runtime_error("pin 2 is no input");
    std::vector<double> ours, theirs;
    for (int turn = 0; turn < kTurns; ++turn) {
        values_for<WebReader>(bus, uno, ours);
        values_for<BrokerReader>(bus, uno, theirs);
    }
    std::printf("a button to its value, p50 of %d: WebSocket %.3f ms, MQTT %.3f ms\n", kRounds, median(ours),
                median(theirs));
    row("value on the board to the browser's end of a WebSocket, p50, over MQTT",
        median(ours) / median(theirs), "x", 1.12, 1.05);
}

void stops() {
    Bus bus;
    Uno robot("asip_uno_robot", R"({"kind":"led","name":"motor","pin":5})");
    Agent agent(bus.broker, robot.port());
    bus.wait_online(agent);
    BusProbe flood(bus.broker.port(), {"flood"});
    HttpConnection http(bus.gateway.port());
    const auto stop = http_request("POST", "/api/stop", "{}");
    std::vector<double> took;
    std::size_t sent = 0;
    for (int round = 0; round < kStops; ++round) {
        for (int i = 0; i < kQueued; ++i, ++sent)
            flood.publish("asip/uno1/motors/in",
                          R"({"power":[0,)" + std::to_string(100 + i % 100) +
                              R"(],"reply_to":"flood","id":")" + std::to_string(sent) + "\"}",
                          false, 0);
        const auto before = flood.count("flood");
        wait_until([&] { return flood.count("flood") > before; });
        const auto begin = Clock::now();
        const auto answer = http.ask(stop);
        took.push_back(Milliseconds(Clock::now() - begin).count());
        if (nlohmann::json::parse(answer)["boards"]["uno1"]["status"] != "ok")
            throw std::runtime_error(answer);
        if (!wait_until([&] { return flood.count("flood") == sent; }, std::chrono::seconds(30)))
            throw std::runtime_error("commands without an answer");
        http.ask(stop);
    }
    std::printf(
        "stop, from its POST to the proof that the board executed it, of %d: p50 %.1f ms, slowest %.1f ms\n",
        kStops, median(took), *std::max_element(took.begin(), took.end()));
    row("stop under 10,000 queued commands, p99", summary(took).p99, "ms", 100, 50);
}

}  // namespace

// Without an argument: all. "stops", "commands" (and values): only those.
int main(int count, char** words) {
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    const std::string_view only = count > 1 ? words[1] : "";
    try {
        if (only != "stops") {
            Bus bus;
            Uno uno("asip_uno_services", R"({"kind":"button","name":"button","pin":2})");
            Agent agent(bus.broker, uno.port());
            bus.wait_online(agent);
            HttpConnection http(bus.gateway.port());
            if (http.ask(http_request("POST", "/api/boards/uno1/services/io/commands/mode",
                                      R"([13,"output"])"))
                    .empty())
                throw std::runtime_error("pin 13 is no output");
            commands(bus);
            values(bus, uno);
        }
        if (only != "commands") stops();
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_gateway_commands: %s\n", error.what());
        return 1;
    }
}
