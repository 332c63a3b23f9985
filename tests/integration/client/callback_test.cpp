// SPDX-License-Identifier: Apache-2.0
// A callback may drop the last handle of its board, on every link and while more is to be delivered. With the
// sanitizers on, what is touched afterwards is found.

#include "asip/client/board.hpp"

#include <gtest/gtest.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <optional>

#include "tests/integration/client/simulated_boards.hpp"
#include "tests/support/bus_probe.hpp"
#include "tests/support/mosquitto_broker.hpp"

namespace asip::client {
namespace {

using test::wait_until;

/// A board that is dropped by its own callback.
class DroppedBoard {
  public:
    boost::asio::awaitable<void> open(std::string address) {
        auto opened = co_await Board::open(io, address);
        if (opened)
            board = std::move(*opened);
        else
            error = to_string(opened.error());
        done = true;
    }
    bool opens(const std::string& address) {
        boost::asio::co_spawn(io, open(address), boost::asio::detached);
        return run_until([this] { return done; }) && board.online();
    }
    template <class Condition>
    bool run_until(Condition condition) {
        return wait_until([&] {
            io.restart();
            io.run_for(std::chrono::milliseconds(10));
            return condition();
        });
    }
    void drop() {
        board = Board();
        ++dropped;
    }

    boost::asio::io_context io;
    Board board;
    Subscription subscription;
    std::string error;
    int dropped = 0;
    bool done = false;
};

/// What an agent says of a board, by a plain client.
void announce(test::BusProbe& agent, const std::string& state) {
    agent.publish(
        "asip/servicebus/uno1/$description",
        R"({"board":"uno1","session":"a","seq":1,"lease":60,"services":[{"name":"io","id":"I","model":"io@1"}]})",
        true);
    agent.publish("asip/servicebus/uno1/$state", state, true);
}

TEST(CallbackDropsTheBoard, OverMqttWhileEventsComeInABurst_NothingMoreIsDelivered) {
    const test::MosquittoBroker broker;
    test::BusProbe agent(broker.port());
    announce(agent, "online");
    DroppedBoard dropped;
    ASSERT_TRUE(dropped.opens(broker.url() + "/uno1")) << dropped.error;
    dropped.subscription = dropped.board.on_analog(0, [&](int) { dropped.drop(); });
    for (int i = 0; i < 200; ++i)
        agent.publish("asip/uno1/io/out", R"({"analog":{"0":)" + std::to_string(i) + "}}");
    ASSERT_TRUE(wait_until([&] { return agent.all_acknowledged(); }));
    ASSERT_TRUE(dropped.run_until([&] { return dropped.dropped > 0; }));
    dropped.io.restart();
    dropped.io.run_for(std::chrono::milliseconds(100));
    EXPECT_EQ(dropped.dropped, 1);
    EXPECT_FALSE(dropped.board.online());
}

TEST(CallbackDropsTheBoard, OverSerial_NothingMoreIsDelivered) {
    test::SimulatedBoards boards({"asip_uno"});
    DroppedBoard dropped;
    ASSERT_TRUE(dropped.opens("serial:" + boards.serial())) << dropped.error;
    dropped.subscription = dropped.board.on_analog(0, [&](int) { dropped.drop(); });
    ASSERT_TRUE(dropped.run_until([&] { return dropped.dropped > 0; }));
    dropped.io.restart();
    dropped.io.run_for(std::chrono::milliseconds(200));
    EXPECT_EQ(dropped.dropped, 1);
}

TEST(CallbackDropsTheBoard, OverTcpWhenItGoesAway_NothingMoreIsDelivered) {
    auto boards = std::make_optional<test::SimulatedBoards>(std::vector<std::string>{"asip_uno"});
    DroppedBoard dropped;
    ASSERT_TRUE(dropped.opens("tcp://127.0.0.1:" + boards->tcp_port())) << dropped.error;
    dropped.subscription = dropped.board.on_presence([&](bool) { dropped.drop(); });
    boards.reset();
    ASSERT_TRUE(dropped.run_until([&] { return dropped.dropped > 0; }));
    EXPECT_EQ(dropped.dropped, 1);
}

}  // namespace
}  // namespace asip::client
