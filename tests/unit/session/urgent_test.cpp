// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "tests/unit/session/scripted_board.hpp"

namespace asip::session {
namespace {

using testing::Contains;
using testing::Not;

SessionOptions at_start_rate() {
    SessionOptions options;
    options.max_baud = 0;
    return options;
}

/// The place of `line` among what the board executed; past the end where it did not.
std::ptrdiff_t place(const ScriptedBoard& board, const std::string& line) {
    return std::find(board.executed.begin(), board.executed.end(), line) - board.executed.begin();
}

class Urgent : public testing::TestWithParam<bool> {
  protected:
    Urgent() {
        bench.board.extensions = GetParam();
        EXPECT_TRUE(bench.start());
        bench.board.executed.clear();
    }
    Bench bench{at_start_rate()};
};

TEST_P(Urgent, AmongFullQueues_IsSentBeforeWhatWaits) {
    std::string held;
    bench.board.mute = true;
    for (int client = 1; client <= 10; ++client)
        for (int i = 0; i < 64; ++i)
            bench.request("S,W,0," + std::to_string(i), {.client = static_cast<ClientId>(client)});
    bench.board.mute = false;
    const auto stop = bench.request("I,d,13,0", {.client = 99, .urgent = true});
    bench.pass(5s);
    ASSERT_NE(bench.end_of(stop), nullptr);
    EXPECT_LE(place(bench.board, "I,d,13,0"), 8) << "what was on the wire already: 63 bytes";
}

TEST_P(Urgent, FenceOverdue_IsSentAtOnce) {
    bench.board.mute = true;
    bench.request("S,W,0,1");
    bench.pass(1600ms);
    bench.board.mute = false;
    bench.board.swallow_fences = 1;
    bench.request("I,d,13,0", {.client = 99, .urgent = true});
    EXPECT_THAT(bench.board.executed, Contains("I,d,13,0")) << "not only after a fence came back";
}

TEST_P(Urgent, WhileAFenceIsOut_IsSentAtOnceAndNotTakenForProven) {
    bench.board.mute = true;
    bench.request("S,W,0,1");
    const auto stop = bench.request("I,d,13,0", {.client = 99, .urgent = true});
    EXPECT_THAT(bench.board.heard, Not(Contains("I,d,13,0")));
    bench.pass(10s);
    ASSERT_NE(bench.end_of(stop), nullptr);
    EXPECT_NE(bench.ending(stop), Ending::kExecuted);
}

TEST_P(Urgent, WhatWaitsIsCancelled_ItIsNeverSentAndUrgentStays) {
    bench.board.mute = true;
    std::vector<RequestId> ids;
    for (int i = 0; i < 40; ++i)
        ids.push_back(bench.request("S,W,0," + std::to_string(i)));
    const auto urgent = bench.request("I,d,13,0", {.client = 99, .urgent = true});
    Actions actions;
    const auto count = bench.session.cancel_waiting(actions);
    EXPECT_GE(count, 30u);
    std::size_t ended = 0;
    for (const auto& action : actions) {
        const auto* end = std::get_if<Finished>(&action);
        ASSERT_NE(end, nullptr);
        EXPECT_EQ(end->ending, Ending::kNotSent);
        EXPECT_EQ(end->not_sent, NotSent::kStopped);
        ++ended;
    }
    EXPECT_EQ(ended, count);
    bench.board.mute = false;
    bench.pass(5s);
    EXPECT_THAT(bench.board.executed, Not(Contains("S,W,0,39")));
    EXPECT_NE(bench.end_of(urgent), nullptr);
    const auto next = bench.request("I,d,13,1");
    bench.pass(5s);
    EXPECT_EQ(bench.ending(next), Ending::kExecuted) << "the next one works";
}

TEST_P(Urgent, TooMany_AreRefused) {
    bench.board.mute = true;
    for (std::size_t i = 0; i < BoardSession::kMaxUrgent + 10; ++i) {
        Actions actions;
        if (!bench.session.submit("I,d,13,0", {.urgent = true}, bench.now, actions)) {
            EXPECT_GE(i, BoardSession::kMaxUrgent);
            return;
        }
    }
    FAIL();
}

INSTANTIATE_TEST_SUITE_P(Boards, Urgent, testing::Bool(), [](const auto& generation) {
    return generation.param ? "WithExtensions" : "Asip04";
});

}  // namespace
}  // namespace asip::session
