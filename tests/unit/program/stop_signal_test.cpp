// SPDX-License-Identifier: Apache-2.0
#include "asip/program/stop_signal.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <chrono>
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

TEST(StopSignalDeathTest, Hangups_StopOnceAndAreNoSecondSignal) {
    EXPECT_EXIT(
        {
            boost::asio::io_context io;
            int stops = 0;
            StopSignal stop(io, [&](int) { ++stops; });
            for (const int number : {SIGHUP, SIGHUP, SIGHUP}) {
                std::raise(number);
                io.run_for(std::chrono::milliseconds(100));
            }
            _exit(stops);
        },
        testing::ExitedWithCode(1), "");
}

TEST(StopSignalDeathTest, HangupBehindTheOrderlyEnd_IsIgnored) {
    EXPECT_EXIT(
        {
            {
                boost::asio::io_context io;
                StopSignal stop(io, [&](int) { io.stop(); });
                std::raise(SIGHUP);
                io.run();
            }
            std::raise(SIGHUP);
            _exit(0);
        },
        testing::ExitedWithCode(0), "");
}

TEST(StopSignalDeathTest, HangupThatIsIgnoredOrHandledElsewhere_StaysSo) {
    EXPECT_EXIT(
        {
            std::signal(SIGHUP, SIG_IGN);
            boost::asio::io_context io;
            StopSignal stop(io, [](int) { _exit(1); });
            std::raise(SIGHUP);
            io.run_for(std::chrono::milliseconds(100));
            _exit(0);
        },
        testing::ExitedWithCode(0), "");
    EXPECT_EXIT(
        {
            boost::asio::io_context io;
            StopSignal stop(io, [](int) {}, StopSignal::Hangup::kElsewhere);
            std::raise(SIGHUP);
        },
        testing::KilledBySignal(SIGHUP), "");
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
