// SPDX-License-Identifier: Apache-2.0
// The way to a board that is kept open: against pseudo-terminals and loopback connections.
#include "asip/link/kept_stream.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>

#include "tests/support/loop.hpp"
#include "tests/support/temp_dir.hpp"
#include "tests/unit/link/pty.hpp"

namespace asip::link {
namespace {

using namespace std::chrono_literals;
using test::run_until;

class KeptStreamTest : public ::testing::Test {
  protected:
    KeptStream::Handlers handlers() {
        return {[this](const StreamOpened& opened) { ups.push_back(opened); },
                [this](const StreamError& error) { downs.push_back(error); },
                [this](std::string_view bytes) { received += bytes; },
                [this](const StreamError& error) { failures.push_back(error); }};
    }
    KeptStream& open(StreamTarget target) {
        stream.emplace(io, std::move(target), handlers());
        stream->start();
        return *stream;
    }
    bool up(std::size_t times = 1) {
        return run_until(io, [&] { return ups.size() >= times; });
    }

    boost::asio::io_context io;
    std::vector<StreamOpened> ups;
    std::vector<StreamError> downs;
    std::vector<StreamError> failures;
    std::string received;
    std::optional<KeptStream> stream;
};

TEST_F(KeptStreamTest, PortIsNotThereYet_OpensItWhenItComes) {
    test::TempDir folder;
    const std::string device = folder.path() / "board";
    open(SerialTarget{device});
    ASSERT_TRUE(run_until(io, [&] { return failures.size() >= 2; }));
    EXPECT_EQ(failures[0].kind, StreamError::Kind::kNotThere);
    EXPECT_TRUE(ups.empty());

    Pty board;
    std::filesystem::create_symlink(board.device(), device);
    ASSERT_TRUE(up());
    EXPECT_EQ(ups[0].baud, 57600U);
    EXPECT_FALSE(ups[0].restarting);
    board.send("@I,d,4,0\n");
    EXPECT_TRUE(run_until(io, [&] { return received == "@I,d,4,0\n"; }));
}

TEST_F(KeptStreamTest, PortIsUnplugged_ReportsItAndOpensTheNextOne) {
    test::TempDir folder;
    const std::string device = folder.path() / "board";
    Pty first;
    std::filesystem::create_symlink(first.device(), device);
    auto& kept = open(SerialTarget{device});
    ASSERT_TRUE(up());
    first.unplug();
    ASSERT_TRUE(run_until(io, [&] { return downs.size() == 1; }));
    kept.write("lost\n");

    Pty second;
    std::filesystem::remove(device);
    std::filesystem::create_symlink(second.device(), device);
    ASSERT_TRUE(up(2));
    kept.write("I,p\n");
    std::string seen;
    EXPECT_TRUE(run_until(io, [&] { return (seen += second.read_some()) == "I,p\n"; }));
}

TEST_F(KeptStreamTest, RateIsSetBetweenWhatWasWrittenBeforeAndAfter) {
    Pty board;
    auto& kept = open(SerialTarget{board.device()});
    ASSERT_TRUE(up());
    std::optional<bool> set;
    kept.write("before\n");
    kept.set_rate(500'000, [&](bool ok) { set = ok; });
    kept.write("after\n");
    std::string seen = board.read_some();
    EXPECT_EQ(seen, "before\n") << "what is written during the change waits for it";
    ASSERT_TRUE(run_until(io, [&] { return set.has_value(); }));
    EXPECT_TRUE(*set);
    EXPECT_EQ(board.speed(), static_cast<speed_t>(B500000));
    EXPECT_TRUE(run_until(io, [&] { return (seen += board.read_some()) == "before\nafter\n"; }));
}

TEST_F(KeptStreamTest, PortAcceptsNoMoreBytes_IsGivenUpWithBoundedMemoryAndOpenedAgain) {
    Pty board;  // no program reads its other end
    auto& kept = open(SerialTarget{board.device()});
    ASSERT_TRUE(up());
    const std::string line(50, 'x');
    for (int i = 0; i < 10'000 && downs.empty(); ++i) {
        kept.write(line);
        io.poll();
    }
    ASSERT_EQ(downs.size(), 1U);
    EXPECT_NE(downs[0].text.find("accepts no more bytes"), std::string::npos) << downs[0].text;
    EXPECT_TRUE(up(2));
}

TEST_F(KeptStreamTest, RateChangeWaitsForAFullPort_WithoutWakingTheLoop) {
    Pty board;
    auto& kept = open(SerialTarget{board.device()});
    ASSERT_TRUE(up());
    const std::string block(512, 'x');
    bool set = true;
    for (int i = 0; i < 1000 && set; ++i) {
        kept.write(block);
        set = false;
        kept.set_rate(115'200, [&](bool) { set = true; });
        run_until(io, [&] { return set; }, 1s);
    }
    ASSERT_FALSE(set) << "a port that nobody reads accepts everything";
    ASSERT_TRUE(downs.empty());
    EXPECT_LE(io.run_for(200ms), 5U);
    EXPECT_FALSE(set);
}

TEST_F(KeptStreamTest, HandlerDestroysIt_NothingFollows) {
    Pty board;
    stream.emplace(io, SerialTarget{board.device()},
                   KeptStream::Handlers{[](const StreamOpened&) {}, [](const StreamError&) {},
                                        [this](std::string_view bytes) {
                                            received += bytes;
                                            stream.reset();
                                        },
                                        [](const StreamError&) {}});
    stream->start();
    board.send("one\n");
    ASSERT_TRUE(run_until(io, [&] { return !stream; }));
    board.send("two\n");
    test::run_for(io, 20ms);
    EXPECT_EQ(received, "one\n");
}

TEST_F(KeptStreamTest, TcpPeerIsMute_ReopenConnectsAnew) {
    std::vector<std::unique_ptr<ByteStream>> accepted;
    auto listener = listen_tcp(
        io, {"127.0.0.1", 0}, [&](std::unique_ptr<ByteStream> peer) { accepted.push_back(std::move(peer)); });
    ASSERT_TRUE(listener);
    auto& kept = open(TcpAddress{"127.0.0.1", (*listener)->port()});
    ASSERT_TRUE(up());
    kept.reopen("the board does not answer");
    ASSERT_TRUE(up(2));
    ASSERT_EQ(downs.size(), 1U);
    EXPECT_NE(downs[0].text.find("the board does not answer"), std::string::npos);
    EXPECT_TRUE(run_until(io, [&] { return accepted.size() == 2; }));
}

TEST_F(KeptStreamTest, TcpHasNoRate_SetRateReportsFalse) {
    auto listener = listen_tcp(io, {"127.0.0.1", 0}, [](std::unique_ptr<ByteStream>) {});
    ASSERT_TRUE(listener);
    auto& kept = open(TcpAddress{"127.0.0.1", (*listener)->port()});
    ASSERT_TRUE(up());
    std::optional<bool> set;
    kept.set_rate(115'200, [&](bool ok) { set = ok; });
    ASSERT_TRUE(run_until(io, [&] { return set.has_value(); }));
    EXPECT_FALSE(*set);
}

}  // namespace
}  // namespace asip::link
