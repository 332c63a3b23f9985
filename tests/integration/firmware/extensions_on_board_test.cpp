// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "firmware_board.hpp"

namespace asip::firmware {
namespace {

using std::chrono::milliseconds;

class RatesTest : public testing::TestWithParam<std::tuple<std::string, unsigned>> {};

TEST_P(RatesTest, BothSides_FollowAtTheTrueRate) {
    const auto [image, baud] = GetParam();
    sim::BoardConfig config;
    config.image = std::string(ASIP_IMAGES) + "/" + image + ".elf";
    config.host_baud = 57600;
    auto created = sim::Board::create(config);
    ASSERT_TRUE(created) << created.error();
    auto& board = **created;
    ASSERT_TRUE(board.read_line(milliseconds(500)));
    board.send("I,A,0\n");
    board.run_for(milliseconds(100));
    board.take_output();
    board.send("#,B," + std::to_string(baud) + "\n");
    EXPECT_EQ(board.read_line(milliseconds(100)).value().text, "@#,B," + std::to_string(baud));
    board.set_host_baud(baud);
    board.run_for(milliseconds(1));
    board.send("#,E,new\n");
    EXPECT_EQ(board.read_line(milliseconds(100)).value().text, "@#,E,new");
    board.run_for(milliseconds(1000));
    board.send("#,?\n");
    EXPECT_EQ(board.read_line(milliseconds(100)).value().text.substr(0, 4), "@#,?");
    EXPECT_EQ(board.line_errors().cut_by_rate_change, 0u);
    EXPECT_EQ(board.line_errors().receive_overruns, 0u);
}

INSTANTIATE_TEST_SUITE_P(All, RatesTest,
                         testing::Combine(testing::Values(std::string("asip_uno"),
                                                          std::string("asip_uno_serial")),
                                          testing::Values(57600u, 115200u, 250000u, 500000u, 1000000u)),
                         [](const auto& chosen) {
                             return std::get<0>(chosen.param) + "_at_" +
                                    std::to_string(std::get<1>(chosen.param));
                         });

TEST(RateFallbackTest, NoFenceAtTheNewRate_BringsTheOldOneBackAfterHalfASecond) {
    sim::BoardConfig config;
    config.image = std::string(ASIP_IMAGES) + "/asip_uno.elf";
    config.host_baud = 57600;
    auto created = sim::Board::create(config);
    ASSERT_TRUE(created) << created.error();
    auto& board = **created;
    ASSERT_TRUE(board.read_line(milliseconds(500)));
    board.send("I,A,0\n#,B,1000000\n");
    ASSERT_TRUE(board.run_until([&] { return board.board_baud() == 1000000; }, milliseconds(200)));
    board.take_output();
    board.send("#,E,garbled\n");
    board.run_for(milliseconds(490));
    EXPECT_EQ(board.board_baud(), 1000000u);
    board.run_for(milliseconds(20));
    EXPECT_EQ(board.board_baud(), 58824u);
    board.take_output();
    board.send("#,E,back\n");
    EXPECT_EQ(board.read_line(milliseconds(100)).value().text, "@#,E,back");
}

TEST(RateFallbackTest, Reset_ReturnsTo57600) {
    FirmwareBoard board("asip_uno");
    board.step_up(500000);
    board->reset();
    board->run_for(milliseconds(100));
    EXPECT_EQ(board->board_baud(), 58824u);
}

TEST(IdentityTest, Name_SurvivesAResetAndLivesAtTheEndOfTheEeprom) {
    FirmwareBoard board("asip_uno");
    EXPECT_EQ(board.ask("#,I"), "@#,I,");
    EXPECT_EQ(board.ask("#,I,living-room.2"), "@#,I,living-room.2");
    board->reset();
    board->run_for(milliseconds(500));
    board->take_output();
    board.ask("I,A,0");
    EXPECT_EQ(board.ask("#,I"), "@#,I,living-room.2");
    const auto eeprom = board->eeprom();
    for (std::size_t i = 0; i < eeprom.size() - 34; ++i)
        ASSERT_EQ(eeprom[i], 0xFF) << i;
}

TEST(IdentityTest, NameWhileReportsAreOn_IsStoredAndAnswered) {
    FirmwareBoard board("asip_uno");
    board.ask("I,A,50");
    for (int i = 0; i < 8; ++i) {
        const std::string name = "living-room-number-" + std::to_string(i);
        board->run_for(std::chrono::microseconds(7'310 * i));
        board->take_output();
        board->send("#,I," + name + "\n");
        const auto lines = board.lines_within(milliseconds(250));
        EXPECT_EQ(std::count(lines.begin(), lines.end(), "@#,I," + name), 1);
        EXPECT_GE(lines.size(), 5u) << "reports go on meanwhile";
    }
    board.ask("I,A,0");
    EXPECT_EQ(board.ask("#,I"), "@#,I,living-room-number-7");
}

// What every agent does first, while the sensors report.
TEST(RateSwitchTest, RateAskedForWhileReportsAreOn_IsSwitchedTo) {
    for (const char* image : {"asip_uno", "asip_uno_robot"}) {
        for (int i = 0; i < 12; ++i) {
            FirmwareBoard board(image);
            for (const char* request : {"I,A,25", "E,A,25", "B,A,25", "R,A,25"})
                board.ask(request);
            board->run_for(std::chrono::microseconds(1'170 * i));
            board->send("#,B,500000\n");
            ASSERT_TRUE(board->run_until([&] { return board->board_baud() == 500000; }, milliseconds(60)))
                << image << i;
            board->take_output();
            EXPECT_EQ(board->line_errors().cut_by_rate_change, 0u);
            board->send("#,E,up\n");
            const auto lines = board.lines_within(milliseconds(20));
            EXPECT_EQ(std::count(lines.begin(), lines.end(), "@#,E,up"), 1) << image << i;
        }
    }
}

// The clock of a sketch goes on by two milliseconds at once every 43 ms, and always on a chip of 8 MHz.
TEST(RateSwitchTest, RateAskedForAtAnyTime_AnswerHasLeftTheWireBefore) {
    for (const auto& [image, frequency] : {std::pair("asip_uno", 16'000'000u), {"asip_mini8", 8'000'000u}}) {
        FirmwareBoard board(image, "nano", {}, frequency);
        for (int i = 0; i < 600; ++i) {
            board->run_for(std::chrono::microseconds(73 * i % 2'048));
            board->send("#,B,250000\n");
            ASSERT_EQ(board.next_line(), "@#,B,250000") << image << i;
            board->set_host_baud(250000);
            board->run_for(milliseconds(8));
            board->take_output();
            board->send("#,B,57600\n");
            ASSERT_EQ(board.next_line(), "@#,B,57600") << image << i;
            board->set_host_baud(57600);
            board->run_for(milliseconds(8));
        }
        EXPECT_EQ(board->line_errors().cut_by_rate_change, 0u) << image;
    }
}

TEST(ChecksumTest, DamagedRequest_IsRefusedAndTheNextOneWorks) {
    FirmwareBoard board("asip_uno");
    board->send("#,C,1\n");
    board->send("#,E,ok*62\n");
    EXPECT_EQ(board.next_line(), "@#,E,ok*22");
    board->send("#,E,oj*62\n");
    EXPECT_EQ(board.next_line(), "~#,C,10{BAD_CHECKSUM}*0C");
    board->send("#,E,ok*62\n");
    EXPECT_EQ(board.next_line(), "@#,E,ok*22");
}

// 48 bytes may be on their way to a board that is busy with a long answer.
TEST(FlowTest, RequestsInFlightBehindALongAnswer_AreNotLost) {
    FirmwareBoard board("asip_uno");
    board.step_up(500000);
    for (int round = 0; round < 20; ++round) {
        board->send("I,M\n#,E,aaaaaaaa\n#,E,bbbbbbbb\n#,E,cccccccc\n");
        EXPECT_EQ(board.next_line().substr(0, 7), "@I,M,20");
        EXPECT_EQ(board.next_line(), "@#,E,aaaaaaaa");
        EXPECT_EQ(board.next_line(), "@#,E,bbbbbbbb");
        EXPECT_EQ(board.next_line(), "@#,E,cccccccc");
    }
    EXPECT_EQ(board->line_errors().receive_overruns, 0u);
}

// What does not fit is lost, as on any board; but never half a request executed.
TEST(FlowTest, FloodThatOverflows_ExecutesNoMixtureOfRequests) {
    FirmwareBoard board("asip_uno");
    for (int pin = 2; pin < 14; ++pin)
        board.ask("I,P," + std::to_string(pin) + ",3");
    board.step_up(1000000);
    std::string flood;
    for (int i = 0; i < 400; ++i)
        flood += i % 2 == 0 ? "I,d,12,1\n" : "#,?\nI,M\n";
    board->send(flood);
    board->run_for(milliseconds(300));
    board->take_output();
    board->run_for(milliseconds(50));
    board->take_output();
    for (int pin = 2; pin < 14; ++pin) {
        if (pin == 12) continue;
        EXPECT_EQ(board->pin(pin), sim::Level::kLow) << pin;
    }
    // What was lost last may have been a line end.
    board->send("\n");
    board->run_for(milliseconds(5));
    board->take_output();
    EXPECT_EQ(board.ask("#,E,ok"), "@#,E,ok");
}

}  // namespace
}  // namespace asip::firmware
