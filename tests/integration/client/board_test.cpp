// SPDX-License-Identifier: Apache-2.0
// The same calls over each link, to real firmware of both generations.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_future.hpp>
#include <nlohmann/json.hpp>
#include <optional>

#include "asip/client/blocking_board.hpp"
#include "asip/client/board.hpp"
#include "tests/integration/client/simulated_boards.hpp"
#include "tests/support/bus_probe.hpp"
#include "tests/support/mosquitto_broker.hpp"

namespace asip::client {
namespace {

using nlohmann::json;
using protocol::PinMode;
using test::wait_until;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

struct Way {
    std::string link;
    std::string image;

    friend std::ostream& operator<<(std::ostream& out, const Way& way) {
        return out << way.link << " " << way.image;
    }
};

class BoardOverEachLink : public ::testing::TestWithParam<Way> {
  protected:
    BoardOverEachLink() : boards_({GetParam().image}) {
        std::string address = "serial:" + boards_.serial();
        if (GetParam().link == "tcp") {
            address = "tcp://127.0.0.1:" + boards_.tcp_port();
        }
        if (GetParam().link == "mqtt") {
            broker_.emplace();
            agent_.emplace(std::vector<std::string>{ASIP_TEST_AGENT, "--serial", boards_.serial(), "--name",
                                                    "uno", "--broker", broker_->address()});
            address = broker_->url() + "/uno";
        }
        auto opened = BlockingBoard::open(address);
        if (opened) {
            board_ = std::move(*opened);
        } else {
            ADD_FAILURE() << address << ": " << to_string(opened.error()) << (agent_ ? agent_->errors() : "");
        }
    }

    test::SimulatedBoards boards_;
    std::optional<test::MosquittoBroker> broker_;
    std::optional<test::ChildProcess> agent_;
    BlockingBoard board_;
};

TEST_P(BoardOverEachLink, DigitalWrite_LightsTheLed) {
    ASSERT_TRUE(board_.set_pin_mode(13, PinMode::kOutput));
    ASSERT_TRUE(board_.digital_write(13, true));
    EXPECT_TRUE(boards_.wait_for_led("on")) << boards_.output();
    ASSERT_TRUE(board_.digital_write(13, false));
    EXPECT_TRUE(boards_.wait_for_led("off")) << boards_.output();
}

TEST_P(BoardOverEachLink, DigitalRead_FollowsTheButton) {
    ASSERT_TRUE(board_.set_pin_mode(2, PinMode::kInputPullup));
    EXPECT_EQ(board_.digital_read(2), Result<bool>(true));
    boards_.press();
    EXPECT_TRUE(wait_until([&] { return board_.digital_read(2) == Result<bool>(false); }));
    boards_.release();
    EXPECT_TRUE(wait_until([&] { return board_.digital_read(2) == Result<bool>(true); }));
}

TEST_P(BoardOverEachLink, AnalogRead_FollowsThePotentiometer) {
    ASSERT_TRUE(board_.set_analog_period(20ms));
    const auto near = [&](int wanted) {
        return wait_until([&] {
            const auto value = board_.analog_read(0);
            return value && std::abs(*value - wanted) < 20;
        });
    };
    boards_.set_potentiometer("0.25");
    EXPECT_TRUE(near(256));
    boards_.set_potentiometer("0.75");
    EXPECT_TRUE(near(767));
}

TEST_P(BoardOverEachLink, ServiceByName_AnswersCommandsAndReportsEvents) {
    const auto done = board_.command("servo", "write", json::array({0, 90}));
    EXPECT_TRUE(done) << to_string(done.error());
    ASSERT_TRUE(board_.watch("distance"));
    ASSERT_TRUE(board_.command("distance", "report", json::array({50})));
    const auto event = board_.next_event("distance", test::time_limit(5s));
    ASSERT_TRUE(event) << to_string(event.error());
    EXPECT_TRUE(event->contains("distance")) << *event;
}

TEST_P(BoardOverEachLink, WhatTheBoardRefuses_IsItsErrorNotSilence) {
    const auto no_servo = board_.command("servo", "write", json::array({7, 90}));
    ASSERT_FALSE(no_servo);
    EXPECT_EQ(no_servo.error().kind, Error::Kind::kBoard);
    EXPECT_EQ(no_servo.error().code, 7);

    const auto system_pin = board_.digital_write(0, true);
    ASSERT_FALSE(system_pin);
    EXPECT_EQ(system_pin.error().kind, Error::Kind::kBoard);
    EXPECT_TRUE(board_.set_pin_mode(13, PinMode::kOutput)) << "the next call works";
}

TEST_P(BoardOverEachLink, BoardUnplugged_CallsFailAndWorkAgainWhenItIsBackWithItsModes) {
    if (GetParam().link == "tcp") {
        GTEST_SKIP() << "asip-sim unplugs serial ports";
    }
    ASSERT_TRUE(board_.set_pin_mode(13, PinMode::kOutput));
    boards_.command("unplug uno");
    ASSERT_TRUE(wait_until([&] { return !board_.online(); }));
    EXPECT_EQ(board_.digital_write(13, true).error().kind, Error::Kind::kUnreachable);
    boards_.command("replug uno");
    ASSERT_TRUE(wait_until([&] { return board_.online(); })) << boards_.output();
    const auto lit = board_.digital_write(13, true);
    EXPECT_TRUE(lit) << to_string(lit.error());
    EXPECT_TRUE(boards_.wait_for_led("on")) << boards_.output();
}

std::vector<Way> ways() {
    std::vector<Way> all;
    for (const char* link : {"serial", "tcp", "mqtt"}) {
        all.push_back({link, "asip_uno_services"});
        all.push_back({link, "asip_uno_04_services"});
    }
    return all;
}

INSTANTIATE_TEST_SUITE_P(Links, BoardOverEachLink, ::testing::ValuesIn(ways()), [](const auto& param_info) {
    return param_info.param.link + (param_info.param.image == "asip_uno_services" ? "" : "_04");
});

// --- a board that reports on demand

TEST(BlockingBoardOnDemand, Watched_ItReportsAndStopsAfterwards) {
    test::SimulatedBoards boards({"asip_uno_services"});
    const test::MosquittoBroker broker;
    test::ChildProcess agent({ASIP_TEST_AGENT, "--serial", boards.serial(), "--name", "uno", "--broker",
                              broker.address(), "--reports", "on-demand"});
    {
        auto board = BlockingBoard::open(broker.url() + "/uno");
        ASSERT_TRUE(board) << to_string(board.error()) << agent.errors();
        ASSERT_TRUE(board->set_pin_mode(14, PinMode::kAnalog));
        ASSERT_TRUE(board->watch("distance", 20));
        for (int i = 0; i < 5; ++i)
            ASSERT_TRUE(board->next_event("distance", test::time_limit(5s))) << agent.errors();
        EXPECT_TRUE(board->analog_read(0)) << "reading asks for reports, too";
    }
    const test::BusProbe probe(broker.port(), {"asip/uno/distance/out"});
    const auto silent = [&] {
        const auto before = probe.count("asip/uno/distance/out");
        wait_until([] { return false; }, 500ms);
        return probe.count("asip/uno/distance/out") == before;
    };
    EXPECT_TRUE(wait_until(silent, test::time_limit(25s))) << agent.errors();
}

/// Opens the board, demands distances, and closes it at the first, with the stream still there.
Awaitable<int> close_at_first_event(boost::asio::io_context& io, std::string address) {
    const auto board = co_await Board::open(io, address);
    if (!board) co_return Unexpected<Error>(board.error());
    const auto distance = board->service("distance");
    if (!distance) co_return Unexpected<Error>(distance.error());
    auto events = distance->events(20);
    const auto event = co_await events.next(test::time_limit(5s));
    board->close();
    if (!event) co_return Unexpected<Error>(event.error());
    co_return 1;
}

TEST(BoardOnDemand, Closed_ItsBoardIsToldAtOnce) {
    test::SimulatedBoards boards({"asip_uno_services"});
    const test::MosquittoBroker broker;
    test::ChildProcess agent({ASIP_TEST_AGENT, "--serial", boards.serial(), "--name", "uno", "--broker",
                              broker.address(), "--reports", "on-demand"});
    const test::BusProbe probe(broker.port(), {"asip/servicebus/uno/#"});
    ASSERT_TRUE(probe.wait_for("asip/servicebus/uno/$state", "online")) << agent.errors();
    boost::asio::io_context io;
    auto outcome =
        boost::asio::co_spawn(io, close_at_first_event(io, broker.url() + "/uno"), boost::asio::use_future);
    io.run_for(test::time_limit(10s));
    ASSERT_TRUE(io.stopped()) << "closing left something that does not end";
    const auto first = outcome.get();
    ASSERT_TRUE(first) << to_string(first.error()) << agent.errors();
    const auto demands = [&probe] {
        std::vector<std::string> all;
        for (const auto& message : probe.messages())
            if (message.topic.find("/$demand/") != std::string::npos) all.push_back(message.payload);
        return all;
    };
    EXPECT_TRUE(wait_until(
        [&] { return demands().size() > 1 && demands().back().find("distance") == std::string::npos; }));
}

// --- what cannot be opened says why

TEST(BlockingBoardOpen, BoardThatIsNotOnTheBroker_IsNamed) {
    const test::MosquittoBroker broker;
    Options options;
    options.open_timeout = 500ms;
    const auto board = BlockingBoard::open(broker.url() + "/nowhere", options);
    ASSERT_FALSE(board);
    EXPECT_EQ(board.error().kind, Error::Kind::kUnreachable);
    EXPECT_THAT(board.error().text, HasSubstr("no board nowhere"));
}

TEST(BlockingBoardOpen, BrokerRefusesThePassword_IsReportedAtOnce) {
    test::MosquittoBroker::Options secured;
    secured.users = {{"ann", "secret"}};
    const test::MosquittoBroker broker(secured);
    const test::TempDir folder;
    Options options;
    options.user = "ann";
    options.password_file = folder.write("password", "wrong\n");
    const auto begun = std::chrono::steady_clock::now();
    const auto board = BlockingBoard::open(broker.url() + "/uno1", options);
    ASSERT_FALSE(board);
    EXPECT_EQ(board.error().kind, Error::Kind::kUnreachable);
    EXPECT_LT(std::chrono::steady_clock::now() - begun, test::time_limit(5s)) << "trying again cannot help";
}

}  // namespace
}  // namespace asip::client
