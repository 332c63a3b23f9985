// SPDX-License-Identifier: Apache-2.0
// The line is given back as it was found.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/session/board_session_bench.hpp"

namespace asip::session {
namespace {

using State = BoardSession::State;

TEST(Leaving, FastBoard_IsBackAtItsStartRateWithoutChecksums) {
    ReadyBench bench;
    ASSERT_EQ(bench.board.baud, 1'000'000u);
    ASSERT_TRUE(bench.board.checksum);
    bench.leave();
    EXPECT_EQ(bench.session.state(), State::kDown) << "the board answered";
    EXPECT_EQ(bench.board.baud, 57600u);
    EXPECT_FALSE(bench.board.checksum);
    EXPECT_EQ(bench.refused("I,d,13,1"), Refusal::kNoBoard);
}

TEST(Leaving, RequestUnderWay_EndsFirstAndOnesThatWaitAreNotSent) {
    ReadyBench bench;
    bench.hold();
    std::vector<RequestId> requests;
    for (int i = 0; i < 20; ++i)
        requests.push_back(bench.request("I,d,13,1"));
    bench.leave();
    EXPECT_EQ(bench.session.state(), State::kReady) << "fences are out";
    bench.release();
    EXPECT_EQ(bench.session.state(), State::kDown);
    EXPECT_EQ(bench.board.baud, 57600u);
    EXPECT_EQ(bench.ending(requests.front()), Ending::kExecuted);
    EXPECT_EQ(bench.ending(requests.back()), Ending::kNotSent);
}

TEST(Leaving, BoardThatIsMute_IsLeftInAThirdOfASecond) {
    ReadyBench bench;
    bench.board.mute = true;
    bench.request("I,d,13,1");
    bench.leave();
    bench.pass(330ms);
    EXPECT_EQ(bench.session.state(), State::kDown);
}

TEST(Leaving, OldBoard_HearsNothing) {
    Bench bench;
    bench.board.extensions = false;
    ASSERT_TRUE(bench.start());
    const auto heard = bench.board.heard.size();
    bench.leave();
    EXPECT_EQ(bench.session.state(), State::kDown);
    EXPECT_EQ(bench.board.heard.size(), heard);
}

TEST(Leaving, AtOnce_WaitsForNothing) {
    ReadyBench bench;
    bench.hold();
    bench.request("I,d,13,1");
    bench.leave(Leave::kAtOnce);
    EXPECT_EQ(bench.board.baud, 57600u);
}

TEST(Leaving, PortThatComesBack_IsUsedAsBefore) {
    ReadyBench bench;
    bench.leave();
    bench.unplug();
    bench.host_baud = 57600;
    ASSERT_TRUE(bench.start());
    EXPECT_EQ(bench.board.baud, 1'000'000u);
    const auto request = bench.request("I,d,13,1");
    EXPECT_EQ(bench.ending(request), Ending::kExecuted);
}

}  // namespace
}  // namespace asip::session
