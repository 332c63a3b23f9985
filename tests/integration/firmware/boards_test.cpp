// SPDX-License-Identifier: Apache-2.0
// The same sketch on each board, with either driver of the line.
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>

#include "firmware_board.hpp"

namespace asip::firmware {
namespace {

struct Kind {
    const char* image;
    const char* board;
    const char* information;
    int pins;
    int led;
    std::uint32_t frequency = 16'000'000;
};

void PrintTo(const Kind& kind, std::ostream* out) {
    *out << kind.image;
}

class BoardsTest : public testing::TestWithParam<Kind> {};

TEST_P(BoardsTest, Information_Maps_AndPinsWork) {
    const auto& kind = GetParam();
    FirmwareBoard board(kind.image, kind.board, {{"led", {{"pin", kind.led}}, "lamp"}}, kind.frequency);
    EXPECT_EQ(board.ask("#,?"), kind.information);
    for (const char* list : {"#,S", "I,M", "I,p", "I,c"}) {
        const auto answer = board.ask(list);
        EXPECT_EQ(std::count(answer.begin(), answer.end(), ','), kind.pins + 2) << answer;
        EXPECT_EQ(answer.back(), '}');
    }
    const auto led = std::to_string(kind.led);
    EXPECT_EQ(board.ask("I,P," + led + ",3"), "");
    EXPECT_EQ(board.ask("I,d," + led + ",1"), "");
    EXPECT_EQ(board->part("lamp").state(), "on");
    EXPECT_EQ(board.ask("I,d," + led + ",0"), "");
    EXPECT_EQ(board->part("lamp").state(), "off");
    EXPECT_EQ(board.ask("I,d,200,1"), "~I,d,3{INVALID_PIN}");
}

INSTANTIATE_TEST_SUITE_P(
    All, BoardsTest,
    testing::Values(Kind{"asip_uno", "uno", "@#,?,0,4,ATmega328P,20,AsipHello", 20, 13},
                    Kind{"asip_uno_serial", "uno", "@#,?,0,4,ATmega328P,20,AsipPlainSerial", 20, 13},
                    Kind{"asip_mega", "mega", "@#,?,0,4,ATmega2560,70,AsipHello", 70, 13},
                    Kind{"asip_mega_serial", "mega", "@#,?,0,4,ATmega2560,70,AsipPlainSerial", 70, 13},
                    Kind{"asip_leonardo", "leonardo", "@#,?,0,4,ATmega32U4,31,AsipHello", 31, 13},
                    Kind{"asip_nano", "nano", "@#,?,0,4,ATmega328P,22,AsipHello", 22, 13},
                    Kind{"asip_mini8", "nano", "@#,?,0,4,ATmega328P,22,AsipHello", 22, 13, 8'000'000},
                    Kind{"asip_1284p", "1284p", "@#,?,0,4,ATmega1284P,32,AsipHello", 32, 13}),
    [](const auto& chosen) { return std::string(chosen.param.image); });

TEST(MegaTest, InputsOfEveryPort_MakeEvents) {
    FirmwareBoard board("asip_mega", "mega");
    struct Pin {
        int pin;
        const char* event;
    };
    for (const auto& [pin, event] : {Pin{22, "@I,d,1,1"}, Pin{10, "@I,d,2,10"}, Pin{37, "@I,d,3,1"},
                                     Pin{21, "@I,d,4,1"}, Pin{5, "@I,d,5,8"}, Pin{41, "@I,d,7,1"},
                                     Pin{6, "@I,d,8,8"}, Pin{14, "@I,d,10,2"}, Pin{49, "@I,d,12,1"}}) {
        board->drive(pin, sim::Level::kHigh);
        EXPECT_EQ(board.next_line(), event) << pin;
        board->drive(pin, sim::Level::kLow);
        board.next_line();
    }
}

TEST(NanoTest, PinsWithAConverterOnly_AreAnalogInputsAndNothingElse) {
    FirmwareBoard board("asip_nano", "nano");
    EXPECT_EQ(board.ask("I,m"), "@I,m,8,{14:0,15:1,16:2,17:3,18:4,19:5,20:6,21:7}");
    EXPECT_EQ(board.ask("I,c"), "@I,c,22,{1,1,1,5,1,5,5,1,1,5,5,5,1,1,3,3,3,3,3,3,2,2}");
    EXPECT_EQ(board.ask("I,p"), "@I,p,22,{6,6,1,1,1,1,1,1,1,1,1,1,1,1,4,4,4,4,4,4,4,4}");
    EXPECT_TRUE(board.ask("I,M").ends_with(",3:10,3:20,0:0,0:0}"));
    for (const char* request : {"I,P,20,1", "I,P,21,2", "I,P,20,3", "I,P,21,5"})
        EXPECT_EQ(board.ask(request), "~I,P,4{MODE_UNAVAILABLE}") << request;
    EXPECT_EQ(board.ask("I,d,20,1"), "~I,d,6{WRONG_MODE}");
    EXPECT_EQ(board.ask("I,a,21,9"), "~I,a,3{INVALID_PIN}");
    for (int pin = 14; pin < 20; ++pin)
        board.ask("I,P," + std::to_string(pin) + ",0");
    board->set_millivolts(20, 2500);
    board->set_millivolts(21, 5000);
    board.ask("I,A,30");
    EXPECT_EQ(board.next_line(), "@I,a,2,{6:511,7:1023}");
    EXPECT_EQ(board.ask("I,P,20,0"), "");
    EXPECT_EQ(board.next_line(), "@I,a,1,{7:1023}");
    board.ask("#,R");
    EXPECT_EQ(board.ask("I,p"), "@I,p,22,{6,6,1,1,1,1,1,1,1,1,1,1,1,1,4,4,4,4,4,4,4,4}");
}

TEST(Atmega1284Test, InputsOfEveryPort_MakeEventsAndTheSerialPinsAreReserved) {
    FirmwareBoard board("asip_1284p", "1284p");
    EXPECT_TRUE(board.ask("#,S").starts_with("@#,S,32,{I,I,I,I,I,I,I,I,@,@,I,I,"));
    struct Pin {
        int pin;
        const char* event;
    };
    board.ask("I,P,31,1");
    for (const auto& [pin, event] :
         {Pin{31, "@I,d,1,80"}, Pin{7, "@I,d,2,80"}, Pin{16, "@I,d,3,1"}, Pin{10, "@I,d,4,4"}}) {
        board->drive(pin, sim::Level::kHigh);
        EXPECT_EQ(board.next_line(), event) << pin;
        board->drive(pin, sim::Level::kLow);
        board.next_line();
    }
}

// The line at its true rate, both ways, and a servo: what a clock of 8 MHz could spoil.
TEST(EightMegahertzTest, LineAndServos_AreAsAt16) {
    sim::BoardConfig config;
    config.board = "nano";
    config.image = std::string(ASIP_IMAGES) + "/asip_mini8_services.elf";
    config.frequency = 8'000'000;
    config.host_baud = 57600;
    config.parts.push_back({"servo", {{"pin", 9}}, "pan"});
    auto created = sim::Board::create(config);
    ASSERT_TRUE(created) << created.error();
    auto& board = **created;
    ASSERT_TRUE(board.read_line(std::chrono::milliseconds(500)));
    EXPECT_EQ(board.board_baud(), 58824u);
    board.send("I,A,0\nS,W,0,0\n");
    board.run_for(std::chrono::milliseconds(100));
    EXPECT_EQ(board.part("pan").state(), "0");
    board.send("S,W,0,135\n");
    board.run_for(std::chrono::milliseconds(100));
    EXPECT_NEAR(std::stod(board.part("pan").state()), 135, 1.5);
    board.take_output();
    for (const char* rate : {"115200", "1000000"}) {
        board.send(std::string("#,B,") + rate + "\n");
        const auto line = board.read_line(std::chrono::milliseconds(50));
        ASSERT_TRUE(line);
        EXPECT_EQ(line->text, "~#,B,11{BAD_ARGUMENT}") << rate;
    }
    board.send("#,B,500000\n");
    board.run_for(std::chrono::milliseconds(20));
    EXPECT_EQ(board.board_baud(), 500000u);
    board.set_host_baud(500000);
    board.take_output();
    board.send("#,E,up\n");
    const auto line = board.read_line(std::chrono::milliseconds(50));
    ASSERT_TRUE(line);
    EXPECT_EQ(line->text, "@#,E,up");
}

TEST(LeonardoTest, SecondNamesOfPins_AreUnallocated) {
    FirmwareBoard board("asip_leonardo", "leonardo");
    EXPECT_EQ(board.ask("I,p"), "@I,p,31,{6,6,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,4,4,4,4,4,4,0,0,0,0,0,0,0}");
}

TEST(PlainSerialTest, RoundTripAt500000_StaysUnderAMillisecond) {
    FirmwareBoard board("asip_uno_serial", "uno", {{"wire", {{"from", 13}, {"to", 2}}, "wire"}});
    board.ask("I,P,13,3");
    board.step_up(500000);
    for (int i = 0; i < 50; ++i) {
        const auto begin = board->cycles();
        board->send(i % 2 == 0 ? "I,d,13,1\n" : "I,d,13,0\n");
        const auto event = board->read_line(std::chrono::milliseconds(10));
        ASSERT_TRUE(event);
        EXPECT_LT(event->cycle - begin, 16000u);
    }
}

}  // namespace
}  // namespace asip::firmware
