// SPDX-License-Identifier: Apache-2.0
// The catalogue alone: announcements a second, memory a board, queries among 500,000 services, leases by the
// million.
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <random>
#include <vector>

#include "asip/catalogue/catalogue.hpp"
#include "asip/catalogue/due_wheel.hpp"
#include "asip/text/wall_time.hpp"
#include "bench/catalogue_load.hpp"

namespace asip::catalogue {
namespace {

using namespace std::chrono_literals;
using bench::BoardTexts;

constexpr std::uint32_t kBoards = 100'000;

// Processor time of this thread: what else the machine does must not count.
double processor_seconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

double seconds_since(double start) {
    return processor_seconds() - start;
}

void row(const char* measure, double value, const char* unit, const char* must, const char* aim) {
    std::printf("%-66s %12.3f %-6s  must %-9s aim %s\n", measure, value, unit, must, aim);
    std::fflush(stdout);
}

std::size_t heap_bytes() {
    const auto info = mallinfo2();
    return info.uordblks + info.hblkhd;
}

Announcement announcement(const std::string& name, const std::string& payload) {
    return {bus::TopicKind::kDescription, name, payload, false, std::nullopt};
}

struct Texts {
    std::vector<std::string> names;
    std::vector<std::string> payloads;
};

Texts texts(bool distinct, std::uint64_t seq) {
    const BoardTexts boards(distinct);
    Texts result;
    for (std::uint32_t i = 0; i < kBoards; ++i) {
        result.names.push_back(BoardTexts::name(i));
        result.payloads.push_back(boards.description(i, seq));
    }
    return result;
}

// Broker and agents give boards in no order.
std::vector<std::uint32_t> shuffled(unsigned seed) {
    std::vector<std::uint32_t> order(kBoards);
    for (std::uint32_t i = 0; i < kBoards; ++i)
        order[i] = i;
    std::shuffle(order.begin(), order.end(), std::mt19937(seed));
    return order;
}

double apply_all(Catalogue& catalogue, const Texts& load, const std::vector<std::uint32_t>& order, Time now) {
    const double start = processor_seconds();
    for (const std::uint32_t i : order)
        catalogue.apply(announcement(load.names[i], load.payloads[i]), now);
    return kBoards / seconds_since(start);
}

void announcements_and_memory() {
    for (const bool distinct : {false, true}) {
        const Texts first = texts(distinct, 1);
        const Texts second = texts(distinct, 2);
        const auto order = shuffled(1);
        const std::size_t before = heap_bytes();
        Catalogue catalogue;
        const double fresh = apply_all(catalogue, first, order, Time{} + 1h);
        catalogue.settle();
        const double bytes = static_cast<double>(heap_bytes() - before) / kBoards;
        const double renewed = apply_all(catalogue, second, order, Time{} + 1h + 20s);
        const char* const kind = distinct ? "boards with nothing in common" : "boards of 8 sketches";
        char label[100];
        std::snprintf(label, sizeof label, "first announcements of 100,000 %s", kind);
        row(label, fresh, "1/s", distinct ? "170000" : "520000", distinct ? "250000" : "700000");
        std::snprintf(label, sizeof label, "renewals of 100,000 %s", kind);
        row(label, renewed, "1/s", "150000", "500000");
        std::snprintf(label, sizeof label, "memory of one of 100,000 %s, 5 services", kind);
        row(label, bytes, "bytes", "2500", "1000");
    }
}

void queries() {
    Catalogue catalogue;
    const Texts load = texts(false, 1);
    const auto order = shuffled(2);
    apply_all(catalogue, load, order, Time{} + 1h);
    std::mt19937 random(3);
    // A tenth is offline, and all the while boards come and go: each query finds a few changes to put in
    // place.
    Time now = Time{} + 1h + 1s;
    const auto toggle = [&](std::uint32_t board, const char* word) {
        catalogue.apply({bus::TopicKind::kState, load.names[board], word, false, std::nullopt}, now);
    };
    for (std::uint32_t i = 0; i < kBoards; i += 10)
        toggle(i, "offline");
    const char* const kinds[] = {"io", "distance", "servo", "bump", "encoder"};
    std::vector<double> micros;
    std::vector<double> scans;
    bus::Query query;
    query.find = bus::Find::kServices;
    query.state = {"online"};
    const Instant instant{now, text::WallTime{}};
    static_cast<void>(catalogue.find(query, instant));
    for (int i = 0; i < 20'000; ++i) {
        toggle(random() % kBoards, random() % 2 == 0 ? "offline" : "online");
        query.kind = {kinds[random() % 5]};
        query.cursor = load.names[random() % kBoards] + "/" + query.kind[0] + "/";
        const double start = processor_seconds();
        const auto answer = catalogue.find(query, instant);
        micros.push_back(seconds_since(start) * 1e6);
        if (!answer || answer->total == 0u) std::abort();
    }
    bus::Query scan = query;
    scan.sort = "-name";
    scan.cursor.clear();
    scan.state.clear();
    scan.kind.clear();
    scan.service = query.kind[0];
    for (int i = 0; i < 20; ++i) {
        const double start = processor_seconds();
        if (!catalogue.find(scan, instant)) std::abort();
        scans.push_back(seconds_since(start) * 1e6);
    }
    std::sort(micros.begin(), micros.end());
    std::sort(scans.begin(), scans.end());
    row("query by kind and state, 500,000 services, page of 100: p50", micros[micros.size() / 2] / 1000, "ms",
        "-", "-");
    row("query by kind and state, 500,000 services, page of 100: p99",
        micros[micros.size() * 99 / 100] / 1000, "ms", "1", "0.2");
    row("  the same page by a scan of everything: p50", scans[scans.size() / 2] / 1000, "ms", "-", "-");
}

/// Nanoseconds to read and write one of `count` entries of a lease, in no order: what no wheel can be below,
/// once they do not fit into a cache.
double one_entry_in_no_order(std::uint32_t count) {
    struct Entry {
        std::int64_t due, tick;
    };
    std::vector<Entry> entries(count);
    std::mt19937 random(5);
    constexpr int kTimes = 5'000'000;
    const auto draw = [&](bool touch) {
        const double start = processor_seconds();
        std::uint32_t sum = 0;
        for (int i = 0; i < kTimes; ++i) {
            const std::uint32_t place = random() % count;
            if (touch) entries[place].due += ++entries[place].tick;
            sum += place;
        }
        if (sum == 1) std::printf(" ");  // or the loop is left out
        return seconds_since(start) * 1e9 / kTimes;
    };
    const double empty = draw(false);
    return std::max(0.0, draw(true) - empty);
}

void leases() {
    for (const std::uint32_t count : {10'000u, 100'000u, 1'000'000u}) {
        DueWheel wheel;
        std::mt19937 random(4);
        Time now = Time{} + 1h;
        const auto after = [&](unsigned milliseconds) {
            return now + std::chrono::milliseconds(milliseconds);
        };
        for (std::uint32_t i = 0; i < count; ++i)
            wheel.set(i, after(60'000), now);
        std::vector<std::uint32_t> due;
        std::uint64_t operations = 0;
        const double start = processor_seconds();
        // Three leases' time: each second a twentieth renews; one in ten renewals fails, expires and comes
        // back.
        for (int second = 0; second < 180; ++second) {
            for (int tick = 0; tick < 8; ++tick) {
                now += 125ms;
                for (std::uint32_t i = 0; i < count / 160; ++i) {
                    const std::uint32_t slot = random() % count;
                    if (random() % 10 != 0) wheel.set(slot, after(60'000), now), ++operations;
                }
                due.clear();
                wheel.advance(now, due);
                for (const std::uint32_t slot : due)
                    wheel.set(slot, after(60'000), now);
                operations += due.size() * 2;
            }
        }
        char label[100];
        std::snprintf(label, sizeof label, "%u leases renewing and expiring, cost of each step", count);
        row(label, seconds_since(start) * 1e9 / static_cast<double>(operations), "ns", "log n", "constant");
        row("  to touch one of as many entries in no order, and nothing else", one_entry_in_no_order(count),
            "ns", "-", "-");
    }
}

}  // namespace
}  // namespace asip::catalogue

int main() {
    // Blocks handed to the system and back would be counted as memory of the catalogue.
    mallopt(M_MMAP_THRESHOLD, 1 << 30);
    std::printf("(processor time of one thread)\n");
    asip::catalogue::announcements_and_memory();
    asip::catalogue::queries();
    asip::catalogue::leases();
}
