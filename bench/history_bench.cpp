// SPDX-License-Identifier: Apache-2.0
// The registry's history with 10 million rows (or as many as the argument says): how long a board's last 100
// changes take, how long the worst query holds the file, and how long the registry lets others wait
// meanwhile.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "asip/bus/registry/query.hpp"
#include "bench/figures.hpp"
#include "cli/ask/bus_session.hpp"
#include "registry/history/history.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/mosquitto_broker.hpp"
#include "tests/support/temp_dir.hpp"

namespace {

using namespace asip;
using namespace asip::test;
using bench::Milliseconds;

constexpr std::size_t kBoards = 1000;
constexpr std::size_t kAtOnce = 50'000;
constexpr std::size_t kWorstQueries = 16;

std::string board_name(std::size_t number) {
    return "board" + std::to_string(number % kBoards);
}

/// Each board is online, and lost, in turn; within the last day, so that none is too old.
void fill(registry::History& history, std::size_t rows) {
    const auto begin = text::wall_now() - std::chrono::hours(24);
    std::vector<bus::HistoryItem> items;
    for (std::size_t i = 0; i < rows; ++i) {
        const bool online = i / kBoards % 2 == 0;
        bus::HistoryItem item{board_name(i),
                              begin + std::chrono::milliseconds(i / 200),
                              "state",
                              online ? "online" : "lost",
                              online ? "lost" : "online",
                              "lease"};
        items.push_back(std::move(item));
        if (items.size() < kAtOnce && i + 1 < rows) continue;
        history.write(items, {});
        items.clear();
    }
}

bus::Query query_of(const std::string& board, const std::vector<std::string>& state = {}) {
    bus::Query query;
    query.find = bus::Find::kHistory;
    query.board = board;
    query.state = state;
    return query;
}

double milliseconds_of(const std::function<void()>& work) {
    const auto begin = Clock::now();
    work();
    return Milliseconds(Clock::now() - begin).count();
}

/// The file alone.
bool measure_file(registry::History& history) {
    std::vector<double> last, none;
    bool whole = true;
    for (std::size_t i = 0; i < 300; ++i)
        last.push_back(milliseconds_of([&] {
            const auto page = history.find(query_of(board_name(i * 37)));
            whole = whole && page && page->history.size() == 100;
        }));
    // No row is of a board that never had this state: each page looks at as many rows as it may.
    for (const auto* pattern : {"*7*", "board?", "*", "board99*"})
        none.push_back(
            milliseconds_of([&] { (void)history.find(query_of(pattern, {"updating", "sleeping"})); }));
    const auto time = bench::summary(last);
    bench::row("history: last 100 of a board, median", time.p50, "ms", 5, 2);
    bench::row("history: last 100 of a board, 99 of 100 within", time.p99, "ms", 5, 5);
    bench::row("history: a page that matches nothing", *std::max_element(none.begin(), none.end()), "ms", 50,
               10);
    return whole && time.p50 <= 5;
}

/// A registry with that file: others ask for boards while hostile queries are under way.
bool measure_loop(const std::string& file) {
    MosquittoBroker broker;
    ChildProcess registry({ASIP_PROGRAMS "/asip-registry", "--broker", broker.address(), "--id", "bench",
                           "--history", file, "--config", settings_file("history-size = 9000000000\n")});
    if (!registry.wait_for_errors("catalogue is complete")) return false;
    std::stringstream in, out;
    cli::Environment environment{in, out, out};
    environment.mqtt.brokers = {*mqtt::parse_broker(broker.url())};
    cli::BusSession session(environment);
    if (!session.connect()) return false;
    const auto topic = environment.topics.registry_query("bench");
    const auto ask = [&](const bus::Query& query, std::size_t& answers) {
        return session.ask(topic, bus::encode(bus::RegistryRequest{query, {}, {}}),
                           [&answers](const mqtt::Message&) { ++answers; });
    };
    std::vector<double> waits;
    std::size_t hostile_answers = 0;
    for (int round = 0; round < 10; ++round) {
        std::vector<cli::BusSession::Request> hostile;
        for (std::size_t i = 0; i < kWorstQueries; ++i)
            hostile.push_back(
                ask(query_of("*" + std::to_string(i) + "*", {"updating", "sleeping"}), hostile_answers));
        for (int i = 0; i < 20; ++i) {
            std::size_t answered = 0;
            waits.push_back(milliseconds_of([&] {
                const auto request = ask(bus::Query{}, answered);
                session.run_until([&] { return answered != 0; }, Clock::now() + 5s);
            }));
            if (answered == 0) return false;
        }
        session.run_until(
            [&] { return hostile_answers >= kWorstQueries * static_cast<std::size_t>(round + 1); },
            Clock::now() + 10s);
    }
    const auto time = bench::summary(waits);
    std::printf("%zu hostile queries were answered\n", hostile_answers);
    bench::row("registry: a query of boards beside 16 hostile ones of history, median", time.p50, "ms", 50,
               5);
    bench::row("registry: the same, the longest", *std::max_element(waits.begin(), waits.end()), "ms", 50,
               25);
    return hostile_answers == 10 * kWorstQueries;
}

}  // namespace

int main(int argc, char** argv) {
    const std::size_t rows = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 10'000'000;
    const TempDir folder;
    const auto file = folder.file("history.db");
    bool good = false;
    {
        registry::History history({.path = file, .max_bytes = std::size_t{9} << 30U});
        const auto took = milliseconds_of([&] { fill(history, rows); });
        std::printf("%zu rows of %zu boards, written in %.0f s\n", rows, kBoards, took / 1000);
        good = measure_file(history);
    }
    return measure_loop(file) && good ? 0 : 1;
}
