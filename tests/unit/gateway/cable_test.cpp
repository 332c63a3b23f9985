// SPDX-License-Identifier: Apache-2.0
// The cable between a browser that lends a board and the agent of that, from the gateway's side: over real
// Unix sockets, at which the test listens.
#include <gmock/gmock.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <deque>
#include <future>
#include <optional>

#include "clock.hpp"
#include "gateway/cable/agent_way.hpp"
#include "gateway/cable/cable_channel.hpp"
#include "tests/support/loop.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::gateway {
namespace {

using Protocol = boost::asio::local::stream_protocol;
using link::CableKind;

struct CableTest : testing::Test {
    std::unique_ptr<CableChannel> open() {
        CableChannel::Dependencies needs;
        needs.now = [] { return at(0ms); };
        needs.open = [this](CableWay::Handlers handlers) {
            return agent_way(io, work.path().string(), std::move(handlers));
        };
        needs.hello = "{}";
        needs.named = [](const std::string&) {};
        needs.ended = [](const std::string&) {};
        return std::make_unique<CableChannel>(streams, std::move(needs), Principal{}, "test");
    }
    /// The next message that the agent gets.
    std::optional<link::CableMessage> next(Protocol::socket& agent) {
        std::optional<link::CableMessage> message;
        test::run_until(io, [&] {
            std::string bytes(agent.available(), '\0');
            if (!bytes.empty()) agent.read_some(boost::asio::buffer(bytes));
            reader.take(bytes);
            message = reader.next();
            return message.has_value();
        });
        return message;
    }

    test::TempDir work;
    boost::asio::io_context io;
    Protocol::acceptor acceptor{io, Protocol()};
    Protocol::endpoint path{work.file("gateway")};
    Streams streams{10};
    link::CableReader reader;
};

TEST_F(CableTest, RightThatEnds_AgentIsToldThoughTheBrowserReadsNothing) {
    acceptor.bind(path);
    acceptor.listen();
    const auto channel = open();
    auto agent = acceptor.accept();
    ASSERT_EQ(next(agent)->kind, CableKind::kHello);
    channel->revoke();
    const auto told = next(agent);
    ASSERT_TRUE(told);
    EXPECT_EQ(told->kind, CableKind::kEnd);
    EXPECT_EQ(told->payload, "the right to lend it has ended");
}

TEST_F(CableTest, QuietCable_SaysThatItIsThere) {
    acceptor.bind(path);
    acceptor.listen();
    const auto channel = open();
    std::string message;
    channel->tick(at(900ms));
    EXPECT_FALSE(channel->take(message));
    channel->tick(at(1s));
    channel->tick(at(15s));
    ASSERT_TRUE(channel->take(message));
    EXPECT_EQ(message, "A");
    EXPECT_FALSE(channel->take(message)) << "nothing piles up for a browser that takes nothing";
    channel->tick(at(15s));
    EXPECT_TRUE(channel->take(message));
}

TEST_F(CableTest, AgentThatTakesNoConnections_IsNotWaitedFor) {
    acceptor.bind(path);
    acceptor.listen(0);
    std::deque<Protocol::socket> others;
    for (bool taken = true; taken;) {
        auto& other = others.emplace_back(io, Protocol());
        other.non_blocking(true);
        taken = ::connect(other.native_handle(), path.data(), static_cast<socklen_t>(path.size())) == 0;
    }
    auto opening = std::async(std::launch::async, [this] { return open(); });
    EXPECT_EQ(opening.wait_for(5s), std::future_status::ready) << "the gateway's loop stands still";
    acceptor.close();
    const auto channel = opening.get();
    std::string message;
    ASSERT_TRUE(test::run_until(io, [&] { return channel->take(message); }));
    EXPECT_EQ(message, "Eno agent takes lent boards now");
}

}  // namespace
}  // namespace asip::gateway
