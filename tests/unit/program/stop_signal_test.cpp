// SPDX-License-Identifier: Apache-2.0
#include "asip/program/stop_signal.hpp"

#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <csignal>

#include "tests/support/loop.hpp"

namespace asip::program {
namespace {

TEST(StopSignal, First_CallsStop) {
    boost::asio::io_context io;
    int seen = 0;
    StopSignal stop(io, [&](int number) { seen = number; });
    std::raise(SIGTERM);
    EXPECT_TRUE(test::run_until(io, [&] { return seen == SIGTERM; }));
}

TEST(StopSignalDeathTest, Second_EndsTheProcess) {
    EXPECT_EXIT(
        {
            boost::asio::io_context io;
            StopSignal stop(io, [](int) { std::raise(SIGINT); });
            std::raise(SIGINT);
            io.run();
        },
        testing::ExitedWithCode(128 + SIGINT), "");
}

TEST(StopSignal, Cancelled_LetsTheLoopEnd) {
    boost::asio::io_context io;
    StopSignal stop(io, [](int) {});
    stop.cancel();
    io.run();
    EXPECT_TRUE(io.stopped());
}

}  // namespace
}  // namespace asip::program
