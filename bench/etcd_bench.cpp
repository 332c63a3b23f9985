// SPDX-License-Identifier: Apache-2.0
// The catalogue of a registry beside etcd with the same boards: each a lease, its description and a key for
// each of its five services.
//   bench_etcd [BOARDS]
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <thread>

#include "asip/bus/registry/query.hpp"
#include "bench/etcd_client.hpp"
#include "bench/figures.hpp"
#include "bench/mqtt_client.hpp"
#include "bench/retained_boards.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip {
namespace {

using bench::BoardTexts;
using bench::Milliseconds;
using bench::Seconds;
using test::ChildProcess;

constexpr const char* kEtcd = "/usr/bin/etcd";
constexpr int kQueries = 300;
constexpr int kClients = 8;
// Each of etcd's keep-alives waits for its answer: with more at once it is asked for more.
constexpr int kKeepers = 32;
constexpr int kAtOnce = 50;
constexpr auto kRenewing = std::chrono::seconds(5);

struct Figures {
    double load = 0;  // seconds
    bench::Latency board, page;
    double renewals = 0;  // a second
    double restart = 0;   // seconds
    double megabytes = 0;
};

double seconds_since(Time start) {
    return Seconds(Clock::now() - start).count();
}

/// Runs `call(client, number)` for each number below `count`, by several clients at once, until it returns
/// false.
template <class Call>
void by_several(std::uint16_t port, int clients, std::uint32_t count, Call call) {
    std::atomic<std::uint32_t> next{0};
    std::vector<std::thread> threads;
    for (int i = 0; i < clients; ++i)
        threads.emplace_back([&] {
            bench::EtcdClient client(port);
            for (std::uint32_t number = next++; number < count; number = next++)
                if (!call(client, number)) return;
        });
    for (auto& thread : threads)
        thread.join();
}

template <class Ask>
bench::Latency latency(Ask ask) {
    std::vector<double> samples;
    for (int i = 0; i < kQueries; ++i) {
        const Time start = Clock::now();
        ask(i);
        samples.push_back(Milliseconds(Clock::now() - start).count());
    }
    return bench::summary(std::move(samples));
}

class Etcd {
  public:
    Etcd() : port_(test::free_port()), peer_(test::free_port()) { start(); }

    Figures measure(std::uint32_t boards) {
        Figures figures;
        Time began = Clock::now();
        by_several(port_, kClients, boards, [](bench::EtcdClient& client, std::uint32_t board) {
            client.grant(board + 1, 3600);
            client.put(board + 1, keys_of(board));
            return true;
        });
        figures.load = seconds_since(began);
        bench::EtcdClient client(port_);
        figures.board = latency([&](int i) { client.get("boards/" + name(i, boards)); });
        figures.page = latency(
            [&](int i) { client.range("kinds/distance/" + name(i, boards), "kinds/distance0", 100); });
        figures.renewals = renewals(boards);
        figures.megabytes = static_cast<double>(process_->resident_bytes()) / 1e6;
        process_->signal(SIGKILL);
        process_->wait_exit();
        began = Clock::now();
        start();
        bench::EtcdClient(port_).get("boards/" + BoardTexts::name(0));
        figures.restart = seconds_since(began);
        return figures;
    }

  private:
    static std::string name(int i, std::uint32_t boards) {
        return BoardTexts::name(static_cast<std::uint32_t>(i) * 7919u % boards);
    }
    static std::vector<std::pair<std::string, std::string>> keys_of(std::uint32_t board) {
        const auto text = BoardTexts::name(board);
        std::vector<std::pair<std::string, std::string>> keys{
            {"boards/" + text, BoardTexts().description(board, 1, 3600)}};
        for (const char* kind : {"io", "distance", "servo", "bump", "encoder"})
            keys.emplace_back(std::string("kinds/") + kind + "/" + text, "online");
        return keys;
    }

    double renewals(std::uint32_t boards) {
        std::atomic<bool> over{false};
        std::atomic<std::uint64_t> renewed{0};
        const Time began = Clock::now();
        std::thread clock([&] {
            std::this_thread::sleep_for(kRenewing);
            over = true;
        });
        by_several(port_, kKeepers, 1u << 30, [&](bench::EtcdClient& client, std::uint32_t number) {
            if (over) return false;
            client.keep_alive(number % boards + 1);
            ++renewed;
            return true;
        });
        clock.join();
        return static_cast<double>(renewed) / seconds_since(began);
    }

    void start() {
        const auto client = "http://127.0.0.1:" + std::to_string(port_);
        const auto peer = "http://127.0.0.1:" + std::to_string(peer_);
        process_ = std::make_unique<ChildProcess>(std::vector<std::string>{
            kEtcd, "--data-dir", folder_.file("etcd"), "--listen-client-urls", client,
            "--advertise-client-urls", client, "--listen-peer-urls", peer, "--initial-advertise-peer-urls",
            peer, "--initial-cluster", "default=" + peer, "--log-level", "error", "--quota-backend-bytes",
            "8589934592"});
        if (!test::wait_until([this] { return bench::EtcdClient::answers(port_); }, std::chrono::seconds(60)))
            throw std::runtime_error("etcd does not answer:\n" + process_->errors());
    }

    test::TempDir folder_;
    std::uint16_t port_;
    std::uint16_t peer_;
    std::unique_ptr<ChildProcess> process_;
};

class Registry {
  public:
    Figures measure(std::uint32_t boards) {
        Figures figures;
        start(0);
        Time began = Clock::now();
        bench::retain_boards(broker_, boards);
        bench::MqttClient client(broker_.port());
        client.subscribe("bench/answers");
        ask(client, BoardTexts::name(boards - 1));
        figures.load = seconds_since(began);
        figures.board = latency(
            [&](int i) { ask(client, BoardTexts::name(static_cast<std::uint32_t>(i) * 7919u % boards)); });
        figures.page = latency([&](int) {
            request(client, R"("find":"services","kind":"distance","state":"online","limit":100)");
        });
        figures.renewals = renewals(client, boards);
        figures.megabytes = static_cast<double>(process_->resident_bytes() + broker_.resident_bytes()) / 1e6;
        process_->signal(SIGKILL);
        process_->wait_exit();
        began = Clock::now();
        start(boards);
        figures.restart = seconds_since(began);
        return figures;
    }

  private:
    std::string request(bench::MqttClient& client, const std::string& query) {
        client.publish("asip/registry/bench/query", R"({"reply_to":"bench/answers","id":"1",)" + query + "}",
                       1);
        if (!client.wait(std::chrono::seconds(60))) throw std::runtime_error("the registry does not answer");
        return client.take().front().second;
    }
    std::string ask(bench::MqttClient& client, const std::string& board) {
        return request(client, R"("find":"boards","board":")" + board + "\"");
    }

    /// Descriptions with the next number, as agents renew their leases, so many at a time for each client:
    /// then the broker has to answer. Until the registry answers behind the last one.
    double renewals(bench::MqttClient& asker, std::uint32_t boards) {
        boost::asio::io_context io;
        std::uint32_t renewed = 0;
        int open = kClients;
        std::vector<std::unique_ptr<mqtt::Client>> clients;
        const Time began = Clock::now();
        std::function<void(mqtt::Client&)> send = [&](mqtt::Client& client) {
            if (Clock::now() - began > kRenewing) {
                if (--open == 0) io.stop();
                return;
            }
            for (int k = 0; k < kAtOnce; ++k, ++renewed) {
                auto renewal = bench::description(renewed % boards, 2 + renewed / boards);
                renewal.qos = 0;
                client.publish(std::move(renewal), mqtt::Priority::kAnnouncement);
            }
            client.check([&send, &client] { send(client); });
        };
        for (int i = 0; i < kClients; ++i) {
            mqtt::Client::Handlers handlers;
            handlers.on_connected = [&, i](const mqtt::Connected&) {
                send(*clients[static_cast<std::size_t>(i)]);
            };
            clients.push_back(std::make_unique<mqtt::Client>(io, bench::options_for(broker_), handlers));
            clients.back()->start();
        }
        io.run();
        ask(asker, BoardTexts::name(0));
        const double seconds = seconds_since(began);
        expect_arrived(asker, renewed, boards);
        return renewed / seconds;
    }

    /// None of the last renewals may have been dropped on the way.
    void expect_arrived(bench::MqttClient& asker, std::uint32_t renewed, std::uint32_t boards) {
        for (std::uint32_t number = renewed - std::min(boards, 200u); number < renewed; ++number) {
            const auto answer = ask(asker, BoardTexts::name(number % boards));
            if (answer.find("\"seq\":" + std::to_string(2 + number / boards)) == std::string::npos)
                throw std::runtime_error("a renewal was lost: " + answer);
        }
    }

    void start(std::uint32_t boards) {
        process_ = std::make_unique<ChildProcess>(
            std::vector<std::string>{ASIP_REGISTRY_PROGRAM, "--broker", broker_.address(), "--id", "bench"});
        const auto line = "catalogue is complete  boards=" + std::to_string(boards);
        if (!process_->wait_for_errors(line, std::chrono::seconds(120)))
            throw std::runtime_error("the registry is not complete:\n" + process_->errors());
    }

    test::MosquittoBroker broker_{test::MosquittoBroker::Options{.extra_lines = {"max_queued_messages 0"}}};
    std::unique_ptr<ChildProcess> process_;
};

void row(const char* what, double registry, double etcd, const char* unit, bool more_is_better = false) {
    const double times = more_is_better ? registry / etcd : etcd / registry;
    std::printf("%-44s %12.2f %12.2f  %-10s %8.1f\n", what, registry, etcd, unit, times);
}

int run(std::uint32_t boards) {
    const auto ours = Registry().measure(boards);
    const auto theirs = Etcd().measure(boards);
    std::printf(
        "%u boards of 5 services                     registry with broker   etcd      registry is better "
        "by\n",
        boards);
    row("boards announced until found", ours.load, theirs.load, "s");
    row("one board, p50", ours.board.p50, theirs.board.p50, "ms");
    row("one board, p99", ours.board.p99, theirs.board.p99, "ms");
    row("page of 100 by kind and state, p50", ours.page.p50, theirs.page.p50, "ms");
    row("page of 100 by kind and state, p99", ours.page.p99, theirs.page.p99, "ms");
    row("renewals a second (must 4, aim 8 times)", ours.renewals, theirs.renewals, "/s", true);
    row("kill -9 and restart until it answers", ours.restart, theirs.restart, "s");
    row("memory", ours.megabytes, theirs.megabytes, "MB");
    return 0;
}

}  // namespace
}  // namespace asip

int main(int argc, char** argv) {
    const long boards = argc > 1 ? std::strtol(argv[1], nullptr, 10) : 10'000;
    if (boards < 100 || boards > 1'000'000) {
        std::fprintf(stderr, "bench_etcd: BOARDS must be 100 to 1000000\n");
        return 2;
    }
    if (access(asip::kEtcd, X_OK) != 0) {
        std::printf("%s is not there, and so nothing to compare with: apt-get install etcd-server\n",
                    asip::kEtcd);
        return 0;
    }
    try {
        return asip::run(static_cast<std::uint32_t>(boards));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_etcd: %s\n", error.what());
        return 1;
    }
}
