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
};

void PrintTo(const Kind& kind, std::ostream* out) {
    *out << kind.image;
}

class BoardsTest : public testing::TestWithParam<Kind> {};

TEST_P(BoardsTest, Information_Maps_AndPinsWork) {
    const auto& kind = GetParam();
    FirmwareBoard board(kind.image, kind.board, {{"led", {{"pin", kind.led}}, "lamp"}});
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
                    Kind{"asip_leonardo", "leonardo", "@#,?,0,4,ATmega32U4,31,AsipHello", 31, 13}),
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
        board->drive(pin, sim::Level::high);
        EXPECT_EQ(board.next_line(), event) << pin;
        board->drive(pin, sim::Level::low);
        board.next_line();
    }
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
