// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "monitor.hpp"

namespace asip::sim {
namespace {

using namespace std::chrono_literals;
using testing::Each;
using testing::SizeIs;

constexpr double kFrame57600 = 2800;  // UBRR 34 with U2X: 280 cycles a bit, ten bits
constexpr char kDivider500k = 3;
constexpr char kDivider57600 = 34;
constexpr char kDivider1M = 1;

double cycles_per_byte(const std::vector<ReceivedByte>& bytes) {
    return static_cast<double>(bytes.back().cycle - bytes.front().cycle) /
           static_cast<double>(bytes.size() - 1);
}

void step_up(Monitor& monitor, char divider) {
    EXPECT_EQ(monitor.ask({"B" + std::string(1, divider)}, 1), "b");
}

// simavr's own USART takes eleven bit times for a byte.
TEST(SerialLine, SendingManyBytes_TakesTenBitsEach) {
    Monitor monitor;
    monitor.send("T\x64");
    monitor->run_for(50ms);
    const auto bytes = monitor->take_bytes();
    ASSERT_THAT(bytes, SizeIs(100));
    EXPECT_NEAR(cycles_per_byte(bytes), kFrame57600, 1);
}

TEST(SerialLine, SendingAt500k_UsesTheBufferBeforeTheShiftRegister) {
    Monitor monitor;
    step_up(monitor, kDivider500k);
    monitor.send("T\x64");
    monitor->run_for(5ms);
    const auto bytes = monitor->take_bytes();
    ASSERT_THAT(bytes, SizeIs(100));
    EXPECT_NEAR(cycles_per_byte(bytes), 320, 1);
}

TEST(SerialLine, ReceivingAtWireSpeed_TakesTenBitsEachAndLosesNothing) {
    Monitor monitor;
    std::string sent;
    for (int i = 0; i < 300; ++i)
        sent += {'E', static_cast<char>('a' + i % 26)};
    const auto start = monitor->cycles();
    monitor->send(sent);
    ASSERT_TRUE(monitor->run_until([&] { return monitor->sending() == 0; }, 1s));
    EXPECT_NEAR(static_cast<double>(monitor->cycles() - start), 600 * kFrame57600, 400);
    monitor->run_for(1ms);
    const auto echoed = monitor->take_output();
    ASSERT_THAT(echoed, SizeIs(300));
    for (int i = 0; i < 300; ++i)
        ASSERT_EQ(echoed[static_cast<std::size_t>(i)], 'a' + i % 26);
    EXPECT_EQ(monitor->line_errors().receive_overruns, 0u);
}

TEST(SerialLine, EchoByInterruptsFromSleep_LosesNothingAtAnyRate) {
    for (const char divider : {kDivider57600, kDivider500k, kDivider1M}) {
        Monitor monitor;
        step_up(monitor, divider);
        std::string text;
        for (int i = 0; i < 500; ++i)
            text.push_back(static_cast<char>('A' + i % 26));
        monitor.send("Q");
        EXPECT_EQ(monitor.ask(text + "q", 501), text + "q");
        EXPECT_EQ(monitor->line_errors().receive_overruns, 0u);
        EXPECT_EQ(monitor.ask("Ez", 1), "z") << "polling works again";
    }
}

TEST(SerialLine, RateSetByFirmware_IsReportedAsTheChipRoundsIt) {
    Monitor monitor;
    EXPECT_EQ(monitor->board_baud(), 57143u);
    step_up(monitor, kDivider500k);
    monitor.send("T\x01");
    EXPECT_EQ(monitor->board_baud(), 500000u);
    monitor->take_output();
    step_up(monitor, kDivider1M);
    EXPECT_EQ(monitor.ask("E1", 1), "1");
    EXPECT_EQ(monitor->board_baud(), 1000000u);
}

TEST(SerialLine, FirmwareDoesNotRead_LosesWhatTheChipWouldLoseAndCountsIt) {
    Monitor monitor;
    monitor.send("D\x05");      // five milliseconds deaf
    monitor->send("E1E2E3E4");  // all there after 1.4 ms
    monitor->run_for(20ms);
    // Two bytes in the buffer and one in the shift register survive: E 1 E; the next 'E' that comes is the
    // argument.
    EXPECT_EQ(monitor->take_output(), "1");
    EXPECT_EQ(monitor->line_errors().receive_overruns, 5u);
    EXPECT_EQ(monitor.ask("xEy", 2), "xy")
        << "the E in front takes x for its argument, and then all is well again";
}

TEST(SerialLine, ThreeBytesUnread_NothingLost) {
    Monitor monitor;
    monitor.send("D\x05");
    monitor->send("E1E");
    monitor->run_for(20ms);
    EXPECT_EQ(monitor->line_errors().receive_overruns, 0u);
    EXPECT_EQ(monitor->take_output(), "1");
    EXPECT_EQ(monitor.ask("2", 1), "2");
}

TEST(SerialLine, HostAtAnotherRate_BothDirectionsGarbled) {
    Monitor monitor;
    monitor->set_host_baud(115200);
    monitor.send("Ea");
    monitor->run_for(5ms);
    EXPECT_NE(monitor->take_output(), "a");
    EXPECT_EQ(monitor->line_errors().garbled_to_board, 2u);
    monitor->set_host_baud(57600);
    monitor.send("\0\0\0");
    monitor->run_for(5ms);
    monitor->take_output();
    EXPECT_EQ(monitor.ask("Ea", 1), "a") << "57600 is within 3 % of the board's 57143";
    EXPECT_EQ(monitor->line_errors().garbled_to_host, 0u);
    monitor->send("Ea");
    ASSERT_TRUE(monitor->run_until([&] { return monitor->sending() == 0; }, 10ms));
    monitor->set_host_baud(9600);
    monitor->run_for(5ms);
    EXPECT_NE(monitor->take_output(), "a");
    EXPECT_EQ(monitor->line_errors().garbled_to_host, 1u);
}

TEST(SerialLine, BoardStepsUp_HostThatFollowsUnderstandsAndHostThatDoesNotIsGarbled) {
    Monitor monitor;
    monitor->set_host_baud(57600);
    step_up(monitor, kDivider500k);
    monitor.send("Ea");
    EXPECT_NE(monitor->take_output(), "a");
    EXPECT_GE(monitor->line_errors().garbled_to_board, 1u);
    monitor->set_host_baud(500000);
    monitor.send({"\0\0", 2});
    monitor->take_output();
    EXPECT_EQ(monitor.ask("Ea", 1), "a");
}

TEST(SerialLine, HostChangesItsRateAfterSending_WhatItSentGoesOutAtTheOldRate) {
    Monitor monitor;
    monitor->set_host_baud(57600);
    monitor->send("EaEb");
    monitor->set_host_baud(500000);
    ASSERT_TRUE(monitor->run_until([&] { return monitor->sending() == 0; }, 10ms));
    EXPECT_EQ(monitor->line_errors().garbled_to_board, 0u);
}

TEST(SerialLine, GarbledByte_ArrivesWithFramingErrorFlag) {
    Monitor monitor;
    monitor.send("F");
    monitor->set_host_baud(28800);  // a zero lasts twice as long: the stop bit is looked for in its data
    monitor->send({"\0", 1});
    ASSERT_TRUE(monitor->run_until([&] { return monitor->sending() == 0; }, 10ms));
    monitor->set_host_baud(57600);
    monitor->run_for(1ms);
    EXPECT_EQ(monitor->take_output().substr(0, 1), "f");
}

TEST(SerialLine, CleanByte_ArrivesWithoutFramingErrorFlag) {
    Monitor monitor;
    EXPECT_EQ(monitor.ask("Fq", 2), "-q");
}

TEST(SerialLine, RateChangedUnderAByte_SpoilsItAndCountsIt) {
    Monitor monitor;
    EXPECT_EQ(monitor.ask({"C" + std::string(1, kDivider500k)}, 0), "");
    monitor->run_for(5ms);
    EXPECT_EQ(monitor->take_output(), "");
    EXPECT_EQ(monitor->line_errors().cut_by_rate_change, 1u);
    EXPECT_EQ(monitor.ask("Ea", 1), "a");
}

TEST(SerialLine, RateChangedBetweenBytes_NothingSpoilt) {
    Monitor monitor;
    step_up(monitor, kDivider500k);
    EXPECT_EQ(monitor.ask("Ea", 1), "a");
    step_up(monitor, kDivider57600);
    EXPECT_EQ(monitor.ask("Eb", 1), "b");
    EXPECT_EQ(monitor->line_errors().cut_by_rate_change, 0u);
}

TEST(SerialLine, SentWhileBoardIsReset_IsLostAndTheNextBytesWork) {
    Monitor monitor;
    monitor->send("EaEbEc");
    monitor->run_for(300us);
    monitor->reset();
    EXPECT_EQ(monitor->sending(), 0u);
    ASSERT_TRUE(monitor->read_line(100ms));
    EXPECT_EQ(monitor.ask("Ed", 1), "d");
}

class EveryBoard : public testing::TestWithParam<const char*> {};

TEST_P(EveryBoard, Echo_Works) {
    Monitor monitor({}, GetParam());
    EXPECT_EQ(monitor.ask("E?", 1), "?");
    monitor.send("T\x0a");
    monitor->run_for(10ms);
    EXPECT_NEAR(cycles_per_byte(monitor->take_bytes()), kFrame57600, 1);
}

INSTANTIATE_TEST_SUITE_P(Boards, EveryBoard, testing::Values("uno", "mega", "leonardo"));

}  // namespace
}  // namespace asip::sim
