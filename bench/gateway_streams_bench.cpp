// SPDX-License-Identifier: Apache-2.0
// Server-Sent Events to very many clients: how late values come, and what a client costs.
#include <sys/epoll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <charconv>
#include <cstdio>
#include <string>

#include "bench/figures.hpp"
#include "bench/http_load.hpp"
#include "bench/mqtt_client.hpp"
#include "tests/integration/gateway/running_gateway.hpp"
#include "tests/support/temp_dir.hpp"

namespace {

using namespace asip::bench;
using namespace asip::test;

long nanoseconds_now() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
}

/// Many open streams, read by the thread that calls read().
class Listeners {
  public:
    Listeners(std::uint16_t port, int count) : epoll_(epoll_create1(0)), peers_(std::size_t(count)) {
        const auto request = http_request("GET", "/api/boards/uno1/services/distance/stream");
        for (std::size_t i = 0; i < peers_.size(); ++i) {
            peers_[i].socket = connect_to(port);
            epoll_event event{.events = EPOLLIN, .data = {.u64 = i}};
            epoll_ctl(epoll_, EPOLL_CTL_ADD, peers_[i].socket, &event);
            if (send(peers_[i].socket, request.data(), request.size(), 0) < 0)
                throw std::runtime_error("a stream is refused");
            if (i % 50 == 0) read(0);  // as they come, not all at once
        }
        const auto end = Clock::now() + std::chrono::seconds(30);
        while (begun_ < peers_.size() && Clock::now() < end)
            read(50);
        if (begun_ < peers_.size()) throw std::runtime_error("not all streams begin");
    }
    ~Listeners() {
        for (const auto& peer : peers_)
            close(peer.socket);
        close(epoll_);
    }
    Listeners(const Listeners&) = delete;
    Listeners& operator=(const Listeners&) = delete;

    void read(int wait_ms) {
        epoll_event events[256];
        const int count = epoll_wait(epoll_, events, 256, wait_ms);
        for (int i = 0; i < count; ++i)
            read(peers_[events[i].data.u64]);
    }
    std::vector<double> delays_ms;
    std::size_t left_out = 0;

  private:
    struct Peer {
        int socket = -1;
        bool begun = false;
        std::string text;
    };

    void read(Peer& peer) {
        char buffer[16384];
        const auto size = recv(peer.socket, buffer, sizeof buffer, 0);
        if (size <= 0) throw std::runtime_error("a stream ended");
        const long now = nanoseconds_now();
        peer.text.append(buffer, std::size_t(size));
        if (!peer.begun && peer.text.find("snapshot-end") != std::string::npos) {
            peer.begun = true;
            ++begun_;
        }
        for (auto end = peer.text.find("\n\n"); end != std::string::npos; end = peer.text.find("\n\n")) {
            event(std::string_view(peer.text).substr(0, end), now);
            peer.text.erase(0, end + 2);
        }
    }

    void event(std::string_view text, long now) {
        static constexpr std::string_view kSent = "\"sent\":";
        const auto at = text.find(kSent);
        if (at == text.npos) return;
        long sent = 0;
        std::from_chars(text.data() + at + kSent.size(), text.data() + text.size(), sent);
        delays_ms.push_back(double(now - sent) / 1e6);
        if (text.find("left_out") != text.npos) ++left_out;
    }

    int epoll_;
    std::vector<Peer> peers_;
    std::size_t begun_ = 0;
};

struct Outcome {
    Latency delay;
    double slowest_ms = 0;
    double share = 0;  ///< of the values that came
    double kb_per_client = 0;
};

/// So many clients of one service that has so many values a second.
Outcome measure(int clients, int per_second, std::chrono::seconds time) {
    MosquittoBroker broker({.extra_lines = {"max_queued_messages 0"}});
    RunningGateway gateway(
        broker.address(),
        {"--config",
         settings_file("max-streams = 20000\nmax-connections = 20000\nmax-connections-per-address = "
                       "20000\nmax-client-bytes = 2147483648\n")});
    BusProbe probe(broker.port(), {});
    probe.publish("asip/servicebus/uno1/$description", described("uno1"), true);
    probe.publish("asip/servicebus/uno1/$state", "online", true);
    if (!gateway.ready() || !gateway.becomes("uno1", "online"))
        throw std::runtime_error(gateway.process().errors());
    MqttClient board(broker.port());
    const auto before = gateway.process().resident_bytes();
    Listeners listeners(gateway.port(), clients);
    const auto step = std::chrono::nanoseconds(1'000'000'000 / per_second);
    const long values = per_second * time.count();
    auto due = Clock::now();
    for (long sent = 0; sent < values;) {
        if (Clock::now() >= due) {
            board.publish("asip/uno1/distance/out",
                          R"({"distance":[42],"sent":)" + std::to_string(nanoseconds_now()) + "}");
            board.wait(std::chrono::milliseconds(0));
            due += step;
            ++sent;
        }
        listeners.read(1);
    }
    const auto expected = std::size_t(values) * std::size_t(clients);
    const auto end = Clock::now() + std::chrono::seconds(5);
    while (listeners.delays_ms.size() < expected && Clock::now() < end)
        listeners.read(10);
    const auto after = gateway.process().resident_bytes();
    const auto delays = std::move(listeners.delays_ms);
    return {summary(delays), *std::max_element(delays.begin(), delays.end()),
            double(delays.size()) / double(expected), double(after - before) / 1024 / clients};
}

}  // namespace

int main() {
    rlimit files{};
    getrlimit(RLIMIT_NOFILE, &files);
    files.rlim_cur = files.rlim_max;
    setrlimit(RLIMIT_NOFILE, &files);  // the programs that are started inherit it
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    try {
        const auto many = measure(1000, 50, std::chrono::seconds(10));
        std::printf("1,000 clients: p50 %.1f ms, slowest %.1f ms; %.1f %% of the values came\n",
                    many.delay.p50, many.slowest_ms, many.share * 100);
        row("1,000 SSE clients, 50 values a second each: p99 delay", many.delay.p99, "ms", 100, 30);
        row("  memory of a client", many.kb_per_client, "kB", 32, 16);
        const auto most = measure(10'000, 1, std::chrono::seconds(15));
        std::printf("10,000 clients: p50 %.1f ms, p99 %.1f ms, slowest %.1f ms; %.1f kB each\n",
                    most.delay.p50, most.delay.p99, most.slowest_ms, most.kb_per_client);
        row("10,000 SSE clients, 1 value a second each: values that came", most.share * 100, "%", 100, 100,
            true);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_gateway_streams: %s\n", error.what());
        return 1;
    }
}
