// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/exhaustive/enumerate.hpp"

#include <algorithm>

namespace truth {

namespace {

// Past each time-out: of a look at the board (kLongestGap), what a 0.4 board waits inside a message (1 s),
// the answer to a fence (1.5 s), a command (2 s here), a silent board (4 s).
constexpr Micros kDelays[] = {110 * kMillisecond, 1050 * kMillisecond, 1600 * kMillisecond,
                              2100 * kMillisecond, 4200 * kMillisecond};
constexpr Micros kCuts[] = {30 * kMillisecond, 1600 * kMillisecond, 4200 * kMillisecond};
constexpr Micros kHangs[] = {20 * kMillisecond, 1600 * kMillisecond, 4200 * kMillisecond};
constexpr Micros kUnplugged[] = {5 * kMillisecond, 4200 * kMillisecond};

void add(const ByteFault& fault, bool to_board, std::vector<Faults>& all) {
    Faults faults;
    (to_board ? faults.to_board : faults.to_host).push_back(fault);
    all.push_back(std::move(faults));
}

void add(Incident::Kind kind, Micros at, Micros lasts, std::vector<Faults>& all) {
    Faults faults;
    faults.incidents.push_back({kind, at, lasts});
    all.push_back(std::move(faults));
}

void damage(std::uint64_t byte, bool to_board, std::vector<Faults>& all) {
    using Kind = ByteFault::Kind;
    add({byte, Kind::kLost, 0, 0}, to_board, all);
    add({byte, Kind::kTwice, 0, 0}, to_board, all);
    for (unsigned bit = 0; bit < 8; ++bit)
        add({byte, Kind::kChanged, bit, 0}, to_board, all);
}

template <class Each>
void each_byte(const TrialEnd& calm, Each each) {
    for (auto byte = calm.to_board.from; byte < calm.to_board.until; ++byte)
        each(byte, true);
    for (auto byte = calm.to_host.from; byte < calm.to_host.until; ++byte)
        each(byte, false);
}

}  // namespace

std::vector<Faults> single_faults(const TrialEnd& calm) {
    std::vector<Faults> all;
    each_byte(calm, [&](std::uint64_t byte, bool to_board) {
        damage(byte, to_board, all);
        for (const Micros delay : kDelays)
            add({byte, ByteFault::Kind::kDelayed, 0, delay}, to_board, all);
        for (const Micros cut : kCuts)
            add({byte, ByteFault::Kind::kCut, 0, cut}, to_board, all);
    });
    for (const Micros moment : calm.moments) {
        add(Incident::Kind::kBoardReset, moment, 0, all);
        add(Incident::Kind::kDie, moment, 2 * kSecond, all);
        for (const Micros hang : kHangs)
            add(Incident::Kind::kHang, moment, hang, all);
        for (const Micros unplugged : kUnplugged)
            add(Incident::Kind::kUnplug, moment, unplugged, all);
    }
    return all;
}

}  // namespace truth
