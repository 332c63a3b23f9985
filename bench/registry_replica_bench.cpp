// SPDX-License-Identifier: Apache-2.0
// A registry that starts beside a catalogue and its registry: until when it is right, whom that slows, and
// the memory of each.
//   bench_registry_replica [BOARDS [SERVICES]]
#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/asker.hpp"
#include "tests/support/child_process.hpp"

namespace asip {
namespace {

using bench::Asker;
using bench::BoardTexts;
using bench::SteadyAsker;
using test::ChildProcess;

constexpr auto kStep = std::chrono::milliseconds(100);
constexpr std::size_t kAlone = 500;
constexpr int kCompared = 1000;

double seconds_since(Time start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

double megabytes(std::size_t bytes) {
    return static_cast<double>(bytes) / 1e6;
}

std::unique_ptr<ChildProcess> start(const test::MosquittoBroker& broker, const char* id) {
    return std::make_unique<ChildProcess>(
        std::vector<std::string>{ASIP_REGISTRY_PROGRAM, "--broker", broker.address(), "--id", id});
}

bool complete(ChildProcess& registry, std::uint32_t boards, std::chrono::milliseconds limit) {
    return registry.wait_for_errors("catalogue is complete  boards=" + std::to_string(boards), limit)
        .has_value();
}

/// The boards of an answer, but for when its registry saw them first, and since when as they are.
nlohmann::json items_of(const std::string& payload) {
    auto items = nlohmann::json::parse(payload).at("items");
    for (auto& item : items) {
        item.erase("first_seen");
        item.erase("since");
        item.erase("state_age");
    }
    return items;
}

int differences(boost::asio::io_context& io, Asker& one, Asker& other, std::uint32_t boards) {
    int found = 0;
    for (int i = 0; i < kCompared; ++i) {
        bus::Query query;
        query.board = BoardTexts::name(static_cast<std::uint32_t>(i) * 7919u % boards);
        nlohmann::json answers[2];
        one.ask(query, [&](const std::string& payload) { answers[0] = items_of(payload); });
        other.ask(query, [&](const std::string& payload) { answers[1] = items_of(payload); });
        while (answers[0].is_null() || answers[1].is_null())
            io.run_one();
        if (answers[0] != answers[1]) ++found;
    }
    return found;
}

int run(std::uint32_t boards, std::size_t services) {
    test::MosquittoBroker broker(
        test::MosquittoBroker::Options{.extra_lines = {"max_queued_messages 0", "set_tcp_nodelay true"}});
    bench::retain_boards(broker, boards, BoardTexts(false, services));
    Time began = Clock::now();
    const auto first = start(broker, "bench");
    if (!complete(*first, boards, std::chrono::minutes(5))) {
        std::fprintf(stderr, "the registry did not get all boards:\n%s", first->errors().c_str());
        return 1;
    }
    std::printf("%u boards of %zu services\n", boards, services);
    std::printf("%-60s %9.2f s\n", "first registry is complete after", seconds_since(began));

    boost::asio::io_context io;
    SteadyAsker asker(io, broker, "bench-one", boards);
    asker.begin();
    while (asker.answers() < kAlone)
        io.run_one();
    const auto alone = asker.end();

    began = Clock::now();
    asker.begin();
    const auto second = start(broker, "second");
    while (!complete(*second, boards, std::chrono::milliseconds(0)) && seconds_since(began) < 300)
        io.run_for(kStep);
    const double took = seconds_since(began);
    const auto beside = asker.end();
    Asker one(io, broker, "bench-first"), other(io, broker, "bench-second", "second");
    const int different = differences(io, one, other, boards);

    const auto print = [](const char* what, std::vector<double> samples) {
        const double longest = *std::max_element(samples.begin(), samples.end());
        const auto times = bench::summary(std::move(samples));
        std::printf("%-60s %9.2f / %.2f / %.0f ms\n", what, times.p50, times.p99, longest);
    };
    std::printf("%-60s %9.2f s      must 60\n", "second registry, started beside it, is complete after",
                took);
    std::printf("%-60s %9d\n", "boards of 1,000 that the two tell differently", different);
    print("one board of the first, p50 / p99 / longest: alone", alone);
    print("  while the second starts", beside);
    std::printf("%-60s %9.0f MB, %.0f MB\n", "memory of the registries", megabytes(first->resident_bytes()),
                megabytes(second->resident_bytes()));
    std::printf("%-60s %9.0f MB\n", "memory of the broker", megabytes(broker.resident_bytes()));
    for (const auto& registry : {first.get(), second.get()}) {
        registry->signal(SIGTERM);
        registry->wait_exit();
    }
    return different == 0 ? 0 : 1;
}

}  // namespace
}  // namespace asip

int main(int argc, char** argv) {
    const long boards = argc > 1 ? std::strtol(argv[1], nullptr, 10) : 100'000;
    const long services = argc > 2 ? std::strtol(argv[2], nullptr, 10) : 5;
    if (boards < 1 || boards > 1'000'000 || services < 1 || services > 5) {
        std::fprintf(stderr, "bench_registry_replica: BOARDS must be 1 to 1000000, SERVICES 1 to 5\n");
        return 2;
    }
    return asip::run(static_cast<std::uint32_t>(boards), static_cast<std::size_t>(services));
}
