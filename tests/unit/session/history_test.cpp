// SPDX-License-Identifier: Apache-2.0
// Random histories in simulated time: what the session reports is true whatever the line does. ASIP_HISTORIES
// says how many of each kind, ASIP_SEED runs one again.
#include <gtest/gtest.h>

#include "tests/unit/session/damaged_line.hpp"

namespace asip::session {
namespace {

struct Case {
    const char* name;
    HistoryOptions options;
};

HistoryOptions options(bool extensions, ChecksumPolicy checksum, unsigned max_baud, Faults to, Faults from,
                       bool restarts = true) {
    return {extensions, checksum, max_baud, to, from, restarts, 30s};
}

constexpr Faults kNone{};
constexpr Faults kLoss{.lost = 400};
constexpr Faults kDoubling{.doubled = 400};
constexpr Faults kChange{.changed = 400};
constexpr Faults kStalls{.stalled = 1500};
constexpr Faults kAll{.lost = 1500, .doubled = 1500, .changed = 1500, .stalled = 4000};
constexpr Faults kMuchLoss{.lost = 60};

const Case kCases[] = {
    {"CleanLine", options(true, ChecksumPolicy::kAuto, 1'000'000, kNone, kNone, false)},
    {"CleanLine04", options(false, ChecksumPolicy::kAuto, 0, kNone, kNone, false)},
    {"Restarts", options(true, ChecksumPolicy::kAuto, 1'000'000, kNone, kNone)},
    {"Restarts04", options(false, ChecksumPolicy::kAuto, 0, kNone, kNone)},
    {"LossTowardsTheBoard", options(true, ChecksumPolicy::kNever, 0, kLoss, kNone)},
    {"LossTowardsTheBoard04", options(false, ChecksumPolicy::kNever, 0, kLoss, kNone)},
    {"LossFromTheBoard", options(true, ChecksumPolicy::kNever, 0, kNone, kLoss)},
    {"LossFromTheBoard04", options(false, ChecksumPolicy::kNever, 0, kNone, kLoss)},
    {"Doubling04", options(false, ChecksumPolicy::kNever, 0, kDoubling, kDoubling)},
    {"Stalls", options(true, ChecksumPolicy::kAuto, 0, kStalls, kStalls)},
    {"Stalls04", options(false, ChecksumPolicy::kAuto, 0, kStalls, kStalls)},
    {"Everything", options(true, ChecksumPolicy::kNever, 0, kAll, kAll)},
    {"Everything04", options(false, ChecksumPolicy::kNever, 0, kAll, kAll)},
    {"EverythingWithChecksums", options(true, ChecksumPolicy::kAlways, 0, kAll, kAll)},
    {"EverythingFast", options(true, ChecksumPolicy::kAuto, 1'000'000, kAll, kAll)},
    {"ChangesFast", options(true, ChecksumPolicy::kAuto, 1'000'000, kChange, kChange)},
    {"MuchLossWithChecksums", options(true, ChecksumPolicy::kAlways, 0, kMuchLoss, kMuchLoss)},
};

class Histories : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Lines, Histories, testing::ValuesIn(kCases),
                         [](const auto& each) { return each.param.name; });

int histories() {
    const char* const wanted = std::getenv("ASIP_HISTORIES");
    return wanted != nullptr ? std::atoi(wanted) : 25;
}

TEST_P(Histories, EveryAnswerIsTrueAndInTime) {
    Verdict sum;
    const char* const only = std::getenv("ASIP_SEED");
    const int first = only != nullptr ? std::atoi(only) : 1;
    for (int seed = first; seed <= (only != nullptr ? first : histories()); ++seed) {
        const Verdict verdict = run_history(static_cast<std::uint64_t>(seed), GetParam().options);
        for (const auto& violation : verdict.violations)
            ADD_FAILURE() << "seed " << seed << ": " << violation;
        sum.commands += verdict.commands;
        sum.executed += verdict.executed;
        sum.doubts += verdict.doubts;
        sum.not_sent += verdict.not_sent;
        sum.faults += verdict.faults;
        if (HasFailure() && seed > 3) break;
    }
    EXPECT_GT(sum.executed, sum.commands / 20) << "something must get through";
    std::printf("    %d commands, %llu faults: %d executed, %d in doubt, %d not sent\n", sum.commands,
                static_cast<unsigned long long>(sum.faults), sum.executed, sum.doubts, sum.not_sent);
}

}  // namespace
}  // namespace asip::session
