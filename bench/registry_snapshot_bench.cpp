// SPDX-License-Identifier: Apache-2.0
// A whole snapshot of a registry, page by page, and what another asker notices of it.
//   bench_registry_snapshot [BOARDS]
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "asip/bus/answer.hpp"
#include "asip/bus/query.hpp"
#include "asip/bus/requester.hpp"
#include "asip/mqtt/client.hpp"
#include "bench/figures.hpp"
#include "bench/retained_boards.hpp"
#include "tests/support/child_process.hpp"

namespace asip {
namespace {

using bench::Milliseconds;

/// One who asks a registry, over a connection of its own.
class Asker {
  public:
    Asker(boost::asio::io_context& io, const test::MosquittoBroker& broker, const std::string& name)
        : requester_(name, bus::ReplyTopics(topics_, "", name)),
          client_(io, bench::options_for(broker), handlers()) {
        client_.subscribe(requester_.replies().filter(), {.qos = 1});
        client_.start();
        while (!client_.subscribed())
            io.run_one();
    }
    void ask(const bus::Query& query, std::function<void(const std::string& payload)> done) {
        mqtt::Message message;
        message.topic = topics_.registry_query("bench");
        message.payload = bus::encode(bus::RegistryRequest{query, {}, {}});
        message.qos = 1;
        request_ = requester_.ask(message, client_.v5(),
                                  [done](const mqtt::Message& answer) { done(answer.payload); });
        client_.publish(std::move(message), mqtt::Priority::kReply);
    }

  private:
    mqtt::Client::Handlers handlers() {
        mqtt::Client::Handlers result;
        result.on_message = [this](const mqtt::Message& message) { requester_.take(message); };
        return result;
    }

    bus::Topics topics_;
    bus::Requester requester_;
    bus::Requester::Request request_;
    mqtt::Client client_;
};

/// The boards of a snapshot are counted by their answers' cursors alone: reading 100 MB of JSON here would
/// disturb what is measured. The cursor stands at the beginning of an answer.
std::string cursor_of(const std::string& payload) {
    const auto place = payload.rfind("\"cursor\":\"", payload.find("\"items\":"));
    if (place == std::string::npos) return {};
    const auto begin = place + 10;
    return payload.substr(begin, payload.find('"', begin) - begin);
}

struct Snapshot {
    double seconds = 0;
    double megabytes = 0;
    bench::Latency small;  // query of one board beside it, ms
};

class Run {
  public:
    Run(const test::MosquittoBroker& broker, std::uint32_t boards)
        : boards_(boards), all_(io_, broker, "bench-all"), one_(io_, broker, "bench-one"), pause_(io_) {}

    bench::Latency alone(int count) {
        small_.clear();
        wanted_ = true;
        ask_one();
        while (static_cast<int>(small_.size()) < count)
            io_.run_one();
        wanted_ = false;
        return bench::summary(small_);
    }

    Snapshot snapshot(bool full) {
        Snapshot result;
        small_.clear();
        wanted_ = true;
        ask_one();
        bool complete = false;
        bus::Query query;
        query.limit = bus::Query::kMaxPage;
        query.full = full;
        query.brief = !full;
        const Time start = Clock::now();
        std::function<void()> next = [&] {
            all_.ask(query, [&](const std::string& payload) {
                result.megabytes += static_cast<double>(payload.size()) / 1e6;
                query.cursor = cursor_of(payload);
                if (query.cursor.empty())
                    complete = true;
                else
                    next();
            });
        };
        next();
        while (!complete)
            io_.run_one();
        result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
        result.small = bench::summary(small_);
        wanted_ = false;
        return result;
    }

  private:
    void ask_one() {
        bus::Query query;
        query.board = bench::BoardTexts::name(next_ = (next_ * 7919 + 1) % boards_);
        const Time sent = Clock::now();
        one_.ask(query, [this, sent](const std::string&) {
            small_.push_back(Milliseconds(Clock::now() - sent).count());
            if (!wanted_) return;
            pause_.expires_after(std::chrono::milliseconds(2));
            pause_.async_wait([this](const boost::system::error_code& error) {
                if (!error && wanted_) ask_one();
            });
        });
    }

    std::uint32_t boards_;
    boost::asio::io_context io_;
    Asker all_;
    Asker one_;
    boost::asio::steady_timer pause_;
    std::vector<double> small_;
    std::uint32_t next_ = 0;
    bool wanted_ = false;
};

void print(const char* what, const Snapshot& snapshot, const bench::Latency& alone) {
    std::printf("%-44s %8.2f s  %8.1f MB\n", what, snapshot.seconds, snapshot.megabytes);
    std::printf("  one board asked for beside it, p50 / p99    %8.2f / %.2f ms   (alone %.2f / %.2f ms)\n",
                snapshot.small.p50, snapshot.small.p99, alone.p50, alone.p99);
}

int run(std::uint32_t boards) {
    test::MosquittoBroker broker(test::MosquittoBroker::Options{.extra_lines = {"max_queued_messages 0"}});
    bench::retain_boards(broker, boards);
    test::ChildProcess registry({ASIP_REGISTRY_PROGRAM, "--broker", broker.address(), "--id", "bench"});
    const auto line = "catalogue is complete  boards=" + std::to_string(boards);
    if (!registry.wait_for_errors(line, std::chrono::seconds(120))) {
        std::fprintf(stderr, "the registry did not get all boards:\n%s", registry.errors().c_str());
        return 1;
    }
    Run all(broker, boards);
    const auto alone = all.alone(500);
    std::printf("%u boards of 5 services\n", boards);
    print("snapshot, brief", all.snapshot(false), alone);
    print("snapshot, full", all.snapshot(true), alone);
    registry.signal(15);
    registry.wait_exit();
    return 0;
}

}  // namespace
}  // namespace asip

int main(int argc, char** argv) {
    const long boards = argc > 1 ? std::strtol(argv[1], nullptr, 10) : 120'000;
    if (boards < 1 || boards > 1'000'000) {
        std::fprintf(stderr, "bench_registry_snapshot: BOARDS must be 1 to 1000000\n");
        return 2;
    }
    return asip::run(static_cast<std::uint32_t>(boards));
}
