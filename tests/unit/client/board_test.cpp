// SPDX-License-Identifier: Apache-2.0
#include "asip/client/board.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/co_spawn.hpp>
#include <optional>

#include "tests/unit/client/scripted_transport.hpp"

namespace asip::client {
namespace {

using nlohmann::json;
using protocol::PinMode;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class BoardTest : public ::testing::Test {
  protected:
    BoardTest() {
        auto made = std::make_unique<ScriptedTransport>(io);
        transport = made.get();
        Options options;
        options.read_timeout = std::chrono::milliseconds(20);
        auto opened = run(Board::open(std::move(made), options));
        board = *opened;
    }

    /// Runs the loop until the call has its result.
    template <class T>
    Result<T> run(Awaitable<T> call) {
        std::optional<Result<T>> result;
        boost::asio::co_spawn(
            io,
            [&result, call = std::move(call)]() mutable -> boost::asio::awaitable<void> {
                result.emplace(co_await std::move(call));
            },
            [](std::exception_ptr failed) {
                if (failed) std::rethrow_exception(failed);
            });
        io.restart();
        while (!result && io.run_one() > 0) {
        }
        return result ? std::move(*result) : Result<T>(failure(Error::Kind::kTimeout, "never finished"));
    }

    static ScriptedTransport::Step answers(json answer) {
        return [answer](auto&) { return Result<json>(answer); };
    }

    void report(const std::string& service, const std::string& event) {
        transport->listener->on_event(service, json::parse(event));
    }

    boost::asio::io_context io;
    ScriptedTransport* transport = nullptr;
    Board board;
};

TEST_F(BoardTest, PinCalls_BecomeCommandsOfTheIoService) {
    EXPECT_TRUE(run(board.set_pin_mode(13, PinMode::kOutput)));
    EXPECT_TRUE(run(board.digital_write(13, true)));
    EXPECT_TRUE(run(board.analog_write(9, 128)));
    EXPECT_TRUE(run(board.set_analog_period(std::chrono::milliseconds(50))));
    EXPECT_TRUE(run(board.raw("T,P,440,200")));
    EXPECT_THAT(transport->asked,
                ElementsAre(R"(io {"mode":[13,3]})", R"(io {"write":[13,1]})", R"(io {"pwm":[9,128]})",
                            R"(io {"report":[50]})", "T,P,440,200"));
}

TEST_F(BoardTest, BoardRefusesAWrite_CallFailsWithItsCode) {
    transport->script.push_back([](auto&) { return failure(Error::Kind::kBoard, "WRONG_MODE", 6); });
    const auto done = run(board.digital_write(2, true));
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().kind, Error::Kind::kBoard);
    EXPECT_EQ(to_string(done.error()), "board error 6: WRONG_MODE");
    EXPECT_TRUE(run(board.digital_write(13, true))) << "the next call works";
}

TEST_F(BoardTest, LevelReportedBefore_ReadAnswersAtOnceAndAsksNothing) {
    report("io", R"({"digital":{"2":1,"3":0}})");
    EXPECT_EQ(run(board.digital_read(2)), Result<bool>(true));
    EXPECT_EQ(run(board.digital_read(3)), Result<bool>(false));
    EXPECT_TRUE(transport->asked.empty());
}

TEST_F(BoardTest, LevelNeverReported_ReadAsksForAllLevelsAndSetsNothing) {
    transport->script.push_back(answers(json::parse(R"({"modes":[6,6,2]})")));
    transport->script.push_back(
        [](Transport::Listener&) { return Result<json>(json::parse(R"({"levels":{"2":1}})")); });
    EXPECT_EQ(run(board.digital_read(2)), Result<bool>(true));
    EXPECT_THAT(transport->asked, ElementsAre(R"(io {"modes":[]})", R"(io {"levels":[]})"));
}

TEST_F(BoardTest, ReadOfAnOutput_IsInvalidAndSaysItsMode) {
    transport->script.push_back(answers(json::parse(R"({"modes":{"13":3}})")));
    const auto level = run(board.digital_read(13));
    ASSERT_FALSE(level);
    EXPECT_EQ(level.error().kind, Error::Kind::kInvalid);
    EXPECT_THAT(level.error().text, HasSubstr("its mode is output"));
}

TEST_F(BoardTest, BoardNeverReportsThePin_ReadTimesOut) {
    transport->script.push_back(answers(json::parse(R"({"modes":[1]})")));
    const auto level = run(board.digital_read(0));
    ASSERT_FALSE(level);
    EXPECT_EQ(level.error().kind, Error::Kind::kTimeout);
}

TEST_F(BoardTest, PinBecomesAnOutput_ItsOldLevelIsForgotten) {
    report("io", R"({"digital":{"2":1}})");
    EXPECT_TRUE(run(board.set_pin_mode(2, PinMode::kOutput)));
    transport->script.push_back(answers(json::parse(R"({"modes":[6,6,3]})")));
    EXPECT_FALSE(run(board.digital_read(2)));
}

TEST_F(BoardTest, AnalogReport_AnswersReadsUntilItIsTooOld) {
    report("io", R"({"analog":{"0":320,"1":7}})");
    EXPECT_EQ(run(board.analog_read(0)), Result<int>(320));
    EXPECT_EQ(run(board.analog_read(1)), Result<int>(7));
    const auto other = run(board.analog_read(5));
    ASSERT_FALSE(other);
    EXPECT_EQ(other.error().kind, Error::Kind::kTimeout);
    EXPECT_THAT(other.error().text, HasSubstr("set_analog_period"));
}

TEST_F(BoardTest, EventsThatAreNotWhatTheirModelSays_AreIgnored) {
    report("io", R"({"digital":{"x":1,"2":"high","-1":{}}})");
    report("io", R"({"digital":[1,0],"analog":null})");
    report("io", R"([])");
    report("io", R"({"digital":{"2":1}})");
    EXPECT_EQ(run(board.digital_read(2)), Result<bool>(true));
}

TEST_F(BoardTest, OnDigital_IsCalledForChangesOnly) {
    std::vector<bool> levels;
    const auto subscription = board.on_digital(2, [&](bool level) { levels.push_back(level); });
    report("io", R"({"digital":{"2":1,"3":1}})");
    report("io", R"({"digital":{"2":1,"3":0}})");
    report("io", R"({"digital":{"2":0,"3":0}})");
    EXPECT_THAT(levels, ElementsAre(true, false));
}

TEST_F(BoardTest, DroppedSubscription_IsNotCalledAgainEvenWithinOneEvent) {
    int first_calls = 0;
    int second_calls = 0;
    Subscription second;
    const auto first = board.on_analog(0, [&](int) {
        ++first_calls;
        second.reset();
    });
    second = board.on_analog(0, [&](int) { ++second_calls; });
    report("io", R"({"analog":{"0":1}})");
    report("io", R"({"analog":{"0":2}})");
    EXPECT_EQ(first_calls, 2);
    EXPECT_EQ(second_calls, 0);
}

TEST_F(BoardTest, Stream_KeepsWhatHappenedWhileNobodyWaited) {
    const auto changes = board.digital_changes(2);
    report("io", R"({"digital":{"2":1}})");
    report("io", R"({"digital":{"2":0}})");
    EXPECT_EQ(run(changes.next()), Result<bool>(true));
    EXPECT_EQ(run(changes.next()), Result<bool>(false));
}

TEST_F(BoardTest, Stream_ThatNobodyEmptiesDropsTheOldestAndCounts) {
    auto service = board.service("distance");
    ASSERT_TRUE(service);
    const auto events = service->events();
    for (int i = 0; i < static_cast<int>(Stream<json>::kCapacity) + 3; ++i)
        report("distance", R"({"distance":[)" + std::to_string(i) + "]}");
    EXPECT_EQ(events.dropped(), 3U);
    const auto oldest = run(events.next());
    ASSERT_TRUE(oldest);
    EXPECT_EQ(oldest->dump(), R"({"distance":[3]})");
}

TEST_F(BoardTest, Close_EndsStreamsAndCalls) {
    const auto changes = board.digital_changes(2);
    boost::asio::post(io, [this] { board.close(); });
    const auto change = run(changes.next());
    ASSERT_FALSE(change);
    EXPECT_EQ(change.error().kind, Error::Kind::kClosed);
    EXPECT_TRUE(transport->closed);
    EXPECT_EQ(run(board.digital_write(13, true)).error().kind, Error::Kind::kClosed);
    EXPECT_TRUE(transport->asked.empty());
}

TEST_F(BoardTest, BoardGoesAway_CallsFailUntilItIsBackAndOldLevelsAreForgotten) {
    std::vector<bool> presence;
    const auto subscription = board.on_presence([&](bool there) { presence.push_back(there); });
    report("io", R"({"digital":{"2":1}})");
    transport->listener->on_presence(false);
    EXPECT_FALSE(board.online());
    EXPECT_EQ(run(board.digital_read(2)).error().kind, Error::Kind::kUnreachable);
    EXPECT_EQ(run(board.digital_write(13, true)).error().kind, Error::Kind::kUnreachable);
    transport->listener->on_presence(true);
    EXPECT_TRUE(run(board.digital_write(13, true)));
    EXPECT_FALSE(run(board.digital_read(2))) << "a level of before may not be answered";
    EXPECT_THAT(presence, ElementsAre(false, true));
}

TEST_F(BoardTest, ServiceByName_SendsItsCommandsAndHearsItsEvents) {
    auto distance = board.service("distance");
    ASSERT_TRUE(distance);
    EXPECT_EQ(distance->info().id, 'D');
    transport->script.push_back(answers(json::parse(R"({"distance":[42]})")));
    const auto answer = run(distance->command("measure"));
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->dump(), R"({"distance":[42]})");
    EXPECT_THAT(transport->asked, ElementsAre(R"(distance {"measure":[]})"));

    std::string heard;
    const auto subscription = distance->on_event([&](const json& event) { heard = event.dump(); });
    report("distance", R"({"distance":[7]})");
    EXPECT_EQ(heard, R"({"distance":[7]})");
}

TEST_F(BoardTest, ServiceThatIsNotThere_IsNamedWithThoseThatAre) {
    const auto servo = board.service("servo");
    ASSERT_FALSE(servo);
    EXPECT_EQ(servo.error().text, R"(board uno1 has no service "servo"; it has io, distance)");
}

TEST_F(BoardTest, LastHandleGone_TransportIsClosed) {
    Board copy = board;
    board = Board();
    EXPECT_FALSE(transport->closed);
    // The transport goes with the last handle, so watch the stream that ends with it.
    const auto changes = copy.digital_changes(2);
    copy = Board();
    EXPECT_EQ(run(changes.next()).error().kind, Error::Kind::kClosed);
}

TEST_F(BoardTest, DefaultBoard_FailsEveryCallAsClosed) {
    const Board none;
    EXPECT_EQ(run(none.digital_write(13, true)).error().kind, Error::Kind::kClosed);
    EXPECT_EQ(run(none.digital_read(2)).error().kind, Error::Kind::kClosed);
    EXPECT_EQ(run(none.digital_changes(2).next()).error().kind, Error::Kind::kClosed);
    EXPECT_FALSE(none.service("io"));
    EXPECT_FALSE(none.online());
}

TEST(BoardOpenTest, TransportCannotOpen_ItsReasonIsReturned) {
    boost::asio::io_context io;
    auto transport = std::make_unique<ScriptedTransport>(io);
    transport->opening = failure(Error::Kind::kUnreachable, "/dev/ttyACM0: no such device");
    std::string reason;
    boost::asio::co_spawn(
        io,
        [&]() -> boost::asio::awaitable<void> {
            const auto board = co_await Board::open(std::move(transport), Options());
            reason = board ? "" : to_string(board.error());
        },
        [](std::exception_ptr) {});
    io.run();
    EXPECT_EQ(reason, "unreachable: /dev/ttyACM0: no such device");
}

TEST(BoardLifetimeTest, LoopDestroyedWhileACallWaits_NothingIsTouchedAfterwards) {
    auto io = std::make_unique<boost::asio::io_context>();
    boost::asio::co_spawn(
        *io,
        [&io]() -> boost::asio::awaitable<void> {
            auto board = co_await Board::open(std::make_unique<ScriptedTransport>(*io), Options());
            co_await board->analog_read(0);
        },
        [](std::exception_ptr) {});
    io->poll();
    io.reset();  // under the address sanitizer this is the assertion
}

}  // namespace
}  // namespace asip::client
