// SPDX-License-Identifier: Apache-2.0
// asip-gateway's answers from its catalogue: beside nginx with the same bytes as a file, and beside a
// registry's own answer.
#include <cstdio>
#include <memory>
#include <string>

#include "bench/catalogue_load.hpp"
#include "bench/figures.hpp"
#include "bench/http_load.hpp"
#include "bench/mqtt_client.hpp"
#include "tests/integration/gateway/running_gateway.hpp"

namespace {

using namespace asip::bench;
using namespace asip::test;

constexpr int kBoards = 10'000;
constexpr int kRounds = 7;
constexpr int kPages = 60;

/// nginx with one worker and nothing but files of one folder.
class Nginx {
  public:
    explicit Nginx(const std::string& content) : port_(free_port()) {
        folder_.write("board", content);
        const auto file = folder_.write("nginx.conf", configuration());
        process_ = std::make_unique<ChildProcess>(
            std::vector<std::string>{"/usr/sbin/nginx", "-c", file, "-p", folder_.file("")});
        if (!wait_until([&] { return serves(content); }))
            throw std::runtime_error("nginx: " + process_->errors());
    }
    std::uint16_t port() const { return port_; }

  private:
    bool serves(const std::string& content) const {
        std::setvbuf(stdout, nullptr, _IOLBF, 0);
        try {
            return get(port_, "/board").body == content;
        } catch (const std::exception&) {
            return false;  // it does not listen yet
        }
    }
    std::string configuration() const {
        std::string paths;
        for (const char* kind : {"client_body", "proxy", "fastcgi", "uwsgi", "scgi"})
            paths += std::string(kind) + "_temp_path " + folder_.file(kind) + ";\n";
        return "daemon off;\nmaster_process off;\nworker_processes 1;\nerror_log stderr;\npid " +
               folder_.file("pid") + ";\nevents { worker_connections 1024; }\nhttp {\n" + paths +
               "access_log off;\nsendfile on;\ntcp_nopush on;\nopen_file_cache max=10;\nkeepalive_requests "
               "100000000;\n"
               "default_type application/json;\nserver { listen 127.0.0.1:" +
               std::to_string(port_) + "; root " + folder_.file("") + "; }\n}\n";
    }
    TempDir folder_;
    std::uint16_t port_;
    std::unique_ptr<ChildProcess> process_;
};

void publish_boards(BusProbe& probe) {
    const BoardTexts texts;
    for (std::uint32_t i = 0; i < kBoards; ++i) {
        probe.publish("asip/servicebus/" + BoardTexts::name(i) + "/$description",
                      texts.description(i, 1, 3600), true);
        probe.publish("asip/servicebus/" + BoardTexts::name(i) + "/$state", "online", true);
    }
    if (!wait_until([&] { return probe.all_acknowledged(); }, std::chrono::seconds(60)))
        throw std::runtime_error("the broker does not take the boards");
}

void one_board(RunningGateway& gateway) {
    const std::string target = "/api/boards/" + BoardTexts::name(0);
    const Nginx nginx(get(gateway.port(), target).body);
    Load ours{.port = gateway.port(), .request = http_request("GET", target)};
    Load theirs{.port = nginx.port(), .request = http_request("GET", "/board")};
    std::vector<double> our_rate, their_rate, our_p99, their_p99;
    for (int round = 0; round < kRounds; ++round) {
        our_rate.push_back(run(ours).per_second);
        their_rate.push_back(run(theirs).per_second);
    }
    std::printf("requests per second, median of %d: gateway %.0f, nginx %.0f; %zu bytes\n", kRounds,
                median(our_rate), median(their_rate), get(gateway.port(), target).body.size());
    row("GET of one board, keep-alive, requests per second over nginx's",
        median(our_rate) / median(their_rate), "x", 0.9, 1.0, true);
    ours.per_second = theirs.per_second = median(our_rate) / 2;
    for (int round = 0; round < kRounds; ++round) {
        our_p99.push_back(summary(run(ours).milliseconds).p99);
        their_p99.push_back(summary(run(theirs).milliseconds).p99);
    }
    std::printf("p99 at %.0f requests per second, median of %d: gateway %.3f ms, nginx %.3f ms\n",
                ours.per_second, kRounds, median(our_p99), median(their_p99));
    row("  its p99 at half that load over nginx's at the same", median(our_p99) / median(their_p99), "x", 1.2,
        0.9);
}

void list(const MosquittoBroker& broker, RunningGateway& gateway) {
    ChildProcess registry({ASIP_PROGRAMS "/asip-registry", "--broker", broker.address(), "--id", "bench"});
    if (!registry.wait_for_errors("catalogue is complete")) throw std::runtime_error(registry.errors());
    MqttClient client(broker.port());
    client.subscribe("bench/answers");
    HttpConnection http(gateway.port());
    const auto request = http_request("GET", "/api/boards?limit=1000");
    std::vector<double> ours, theirs;
    std::size_t our_bytes = 0, their_bytes = 0;
    for (int round = 0; round < kPages; ++round) {
        auto begin = Clock::now();
        our_bytes = http.ask(request).size();
        ours.push_back(Milliseconds(Clock::now() - begin).count());
        begin = Clock::now();
        client.publish("asip/registry/bench/query",
                       R"({"find":"boards","limit":1000,"id":"1","reply_to":"bench/answers"})");
        if (!client.wait(std::chrono::seconds(10))) throw std::runtime_error("the registry does not answer");
        theirs.push_back(Milliseconds(Clock::now() - begin).count());
        their_bytes = client.take().front().second.size();
    }
    std::printf(
        "a page of 1,000 boards, p50 of %d: gateway %.2f ms (%zu bytes), registry %.2f ms (%zu bytes)\n",
        kPages, median(ours), our_bytes, median(theirs), their_bytes);
    row("list of 10,000 boards, a page of 1,000, over the registry's own answer",
        median(ours) / median(theirs), "x", 2, 1.2);
}

}  // namespace

int main() {
    try {
        MosquittoBroker broker({.extra_lines = {"max_queued_messages 0"}});
        BusProbe probe(broker.port(), {});
        publish_boards(probe);
        RunningGateway gateway(broker.address());
        const auto all = [&] {
            return get(gateway.port(), "/api/status").json()["mirror"]["boards"] == kBoards;
        };
        if (!gateway.ready() || !wait_until(all, std::chrono::seconds(30)))
            throw std::runtime_error("not all boards: " + gateway.process().errors());
        row("memory with 10,000 boards of 5 services", double(gateway.process().resident_bytes()) / (1 << 20),
            "MB", 100, 40);
        list(broker, gateway);
        one_board(gateway);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_gateway_http: %s\n", error.what());
        return 1;
    }
}
