// SPDX-License-Identifier: Apache-2.0
// A whole snapshot of a registry, page by page, and what another asker notices of it.
//   bench_registry_snapshot [BOARDS]
#include <boost/asio/io_context.hpp>
#include <cstdio>
#include <cstdlib>
#include <functional>

#include "bench/asker.hpp"
#include "tests/support/child_process.hpp"

namespace asip {
namespace {

using bench::Asker;
using bench::SteadyAsker;

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
        : all_(io_, broker, "bench-all"), one_(io_, broker, "bench-one", boards) {}

    bench::Latency alone(std::size_t count) {
        one_.begin();
        while (one_.answers() < count)
            io_.run_one();
        return bench::summary(one_.end());
    }

    Snapshot snapshot(bool full) {
        Snapshot result;
        one_.begin();
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
        result.small = bench::summary(one_.end());
        return result;
    }

  private:
    boost::asio::io_context io_;
    Asker all_;
    SteadyAsker one_;
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
