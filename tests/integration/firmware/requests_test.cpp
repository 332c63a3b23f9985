// SPDX-License-Identifier: Apache-2.0
// Request by request, on the image a maker would load, in the simulated chip.
#include <gtest/gtest.h>

#include "firmware_board.hpp"

namespace asip::firmware {
namespace {

using std::chrono::milliseconds;

struct Exchange {
    const char* request;
    const char* answer;
};

void expect_exchanges(FirmwareBoard& board, std::initializer_list<Exchange> exchanges) {
    for (const auto& [request, answer] : exchanges)
        EXPECT_EQ(board.ask(request), answer) << request;
}

TEST(RequestsTest, Banner_NamesSketchChipAndServices) {
    FirmwareBoard board("asip_uno_services");
    EXPECT_EQ(board.banner(), "!AsipServices running on ATmega328P with Services: I D S ");
}

TEST(RequestsTest, SystemRequests) {
    FirmwareBoard board("asip_uno_services");
    expect_exchanges(board, {
                                {"#,?", "@#,?,0,4,ATmega328P,20,AsipServices"},
                                {"#,N", "@#,N,3,{I:ASIP core IO,D:Distance,S:Servos}"},
                                {"#,S", "@#,S,20,{@,@,I,I,I,I,I,D,D,S,S,I,I,I,I,I,I,I,I,I}"},
                                {"#,X", "@#,X,7,{E:1,I:1,B:1,C:1,V:1,D:1,F:2}"},
                                {"#,q", "~#,q,2{UNKNOWN_REQUEST}"},
                                {"#", "~#,?,2{UNKNOWN_REQUEST}"},
                                {"#,?,1", "~#,?,11{BAD_ARGUMENT}"},
                                {"Z,a", "~Z,?,1{INVALID_SERVICE}"},
                                {"", ""},
                                {"!I,d,13,1", ""},
                            });
}

TEST(RequestsTest, IoLists) {
    FirmwareBoard board("asip_uno_services");
    expect_exchanges(board, {
                                {"I,M",
                                 "@I,M,20,{4:1,4:2,4:4,4:8,4:10,4:20,4:40,4:80,2:1,2:2,2:4,2:8,2:10,2:20,3:1,"
                                 "3:2,3:4,3:8,3:10,3:20}"},
                                {"I,m", "@I,m,6,{14:0,15:1,16:2,17:3,18:4,19:5}"},
                                {"I,p", "@I,p,20,{6,6,1,1,1,1,1,7,7,7,7,1,1,1,4,4,4,4,4,4}"},
                                {"I,c", "@I,c,20,{1,1,1,5,1,5,5,1,1,1,1,5,1,1,3,3,3,3,3,3}"},
                            });
}

TEST(RequestsTest, IoErrors) {
    FirmwareBoard board("asip_uno_services");
    expect_exchanges(board,
                     {
                         {"I", "~I,?,2{UNKNOWN_REQUEST}"},        {"I,z", "~I,z,2{UNKNOWN_REQUEST}"},
                         {"I,P,20,1", "~I,P,3{INVALID_PIN}"},     {"I,P,2,4", "~I,P,4{MODE_UNAVAILABLE}"},
                         {"I,P,7,1", "~I,P,4{MODE_UNAVAILABLE}"}, {"I,P,2,7", "~I,P,5{INVALID_MODE}"},
                         {"I,P,2", "~I,P,11{BAD_ARGUMENT}"},      {"I,d,20,1", "~I,d,3{INVALID_PIN}"},
                         {"I,d,7,1", "~I,d,6{WRONG_MODE}"},       {"I,d,14,0", "~I,d,6{WRONG_MODE}"},
                         {"I,d,2", "~I,d,11{BAD_ARGUMENT}"},      {"I,d,2,x", "~I,d,11{BAD_ARGUMENT}"},
                         {"I,d,2,256", "~I,d,11{BAD_ARGUMENT}"},  {"I,a,20,1", "~I,a,3{INVALID_PIN}"},
                         {"I,a,2,1", "~I,a,3{INVALID_PIN}"},      {"I,a,7,1", "~I,a,3{INVALID_PIN}"},
                         {"I,a,3,256", "~I,a,11{BAD_ARGUMENT}"},  {"I,A,65536", "~I,A,11{BAD_ARGUMENT}"},
                         {"I,A", "~I,A,11{BAD_ARGUMENT}"},        {"I,P,2,256", "~I,P,11{BAD_ARGUMENT}"},
                         {"I,P,2,5", "~I,P,4{MODE_UNAVAILABLE}"}, {"I,d,276,1", "~I,d,3{INVALID_PIN}"},
                     });
}

TEST(RequestsTest, ServiceErrors) {
    FirmwareBoard board("asip_uno_services");
    expect_exchanges(board, {
                                {"S,W,2,90", "~S,W,7{INVALID_DEVICE_NUMBER}"},
                                {"S,W,0,x", "~S,W,11{BAD_ARGUMENT}"},
                                {"S,W,0", "~S,W,11{BAD_ARGUMENT}"},
                                {"S,M,2,3,1", "~S,M,3{INVALID_PIN}"},
                                {"S,M,2,3,7", "~S,M,3{INVALID_PIN}"},
                                {"S,M,2,3,3", "~S,M,3{INVALID_PIN}"},
                                {"S,M,3,3,4", "~S,M,11{BAD_ARGUMENT}"},
                                {"S,M,9,2,3,4,5,6,9,10,11,12", "~S,M,11{BAD_ARGUMENT}"},
                                {"S,A,100", "~S,A,2{UNKNOWN_REQUEST}"},
                                {"D,M,1", "~D,M,11{BAD_ARGUMENT}"},
                                {"D,A,-1", "~D,A,11{BAD_ARGUMENT}"},
                                {"D,x", "~D,x,2{UNKNOWN_REQUEST}"},
                            });
    EXPECT_EQ(board.ask("#,S"), "@#,S,20,{@,@,I,I,I,I,I,D,D,S,S,I,I,I,I,I,I,I,I,I}");
}

TEST(RequestsTest, ServoWhosePinIsTaken_IsNotAvailable) {
    FirmwareBoard board("asip_uno_conflict");
    EXPECT_EQ(board.ask("S,W,0,90"), "~S,W,8{DEVICE_NOT_AVAILABLE}");
    EXPECT_EQ(board.ask("S,M,1,10"), "");
    EXPECT_EQ(board.ask("S,W,0,90"), "");
}

TEST(RequestsTest, DigitalWriteAndEvent_GoThroughTheWire) {
    FirmwareBoard board("asip_uno", "uno", {{"wire", {{"from", 13}, {"to", 2}}, "wire"}});
    EXPECT_EQ(board.ask("I,P,13,3"), "");
    EXPECT_EQ(board.ask("I,P,2,1"), "@I,d,4,0");
    EXPECT_EQ(board.ask("I,d,13,1"), "@I,d,4,4");
    EXPECT_EQ(board->pin(13), sim::Level::kHigh);
    EXPECT_EQ(board.ask("I,d,13,0"), "@I,d,4,0");
}

TEST(RequestsTest, PullUp_HoldsThePinHighAndAButtonPullsItLow) {
    FirmwareBoard board("asip_uno", "uno", {{"button", {{"pin", 4}, {"steady", true}}, "button"}});
    EXPECT_EQ(board.ask("I,P,4,2"), "@I,d,4,10");
    ASSERT_TRUE(board->part("button").command("press", ""));
    EXPECT_EQ(board.next_line(), "@I,d,4,0");
    ASSERT_TRUE(board->part("button").command("release", ""));
    EXPECT_EQ(board.next_line(), "@I,d,4,10");
}

TEST(RequestsTest, Levels_ComeInOneEventAndLeaveALampOn) {
    FirmwareBoard board(
        "asip_uno", "uno",
        {{"button", {{"pin", 4}, {"steady", true}}, "button"}, {"led", {{"pin", 13}}, "lamp"}});
    board.ask("I,P,4,2");
    board.ask("I,P,13,3");
    board.ask("I,d,13,1");
    for (int i = 0; i < 100; ++i)
        ASSERT_EQ(board.ask("I,L"), "@I,L,3,{2:0,3:0,4:10}");
    EXPECT_EQ(board->part("lamp").state(), "on");
    ASSERT_TRUE(board->part("button").command("press", ""));
    EXPECT_EQ(board.next_line(), "@I,d,4,0");
    EXPECT_EQ(board.ask("I,L"), "@I,L,3,{2:0,3:0,4:0}");
    EXPECT_EQ(board.ask("I,p"), "@I,p,20,{6,6,1,1,2,1,1,1,1,1,1,1,1,3,4,4,4,4,4,4}");
}

TEST(RequestsTest, LevelsOfAMega_HaveEachOfItsPorts) {
    FirmwareBoard board("asip_mega", "mega",
                        {{"button", {{"pin", 22}, {"to_vcc", true}, {"steady", true}}, "switch"}});
    ASSERT_TRUE(board->part("switch").command("press", ""));
    EXPECT_EQ(board.next_line(), "@I,d,1,1");
    EXPECT_EQ(board.ask("I,L"), "@I,L,12,{1:1,2:0,3:0,4:0,5:0,6:0,7:0,8:0,9:0,10:0,11:0,12:0}");
}

TEST(RequestsTest, LevelsWithoutTheExtension_AreAnUnknownRequest) {
    FirmwareBoard board("asip_uno_04");
    EXPECT_EQ(board.ask("I,L"), "~I,L,2{UNKNOWN_REQUEST}");
}

TEST(RequestsTest, AnalogEvents_ComeEachPeriodWithTheVoltages) {
    FirmwareBoard board("asip_uno");
    board->set_millivolts(14, 2500);
    board->set_millivolts(19, 5000);
    for (int pin = 15; pin < 19; ++pin)
        board.ask("I,P," + std::to_string(pin) + ",0");
    board.ask("I,A,50");
    const auto lines = board.lines_within(milliseconds(1020));
    ASSERT_EQ(lines.size(), 20u);
    for (const auto& line : lines)
        EXPECT_EQ(line, "@I,a,2,{0:511,5:1023}");
}

TEST(RequestsTest, PwmDuty_ReachesTheTimerOfThePin) {
    constexpr std::uint16_t kOcr0a = 0x47, kTccr0a = 0x44;
    FirmwareBoard board("asip_uno");
    board.ask("I,P,6,5");
    EXPECT_EQ(board.ask("I,a,6,64"), "");
    EXPECT_EQ(board->peek(kOcr0a), 64);
    EXPECT_EQ(board->peek(kTccr0a) & 0xC0, 0x80);
    EXPECT_EQ(board.ask("I,P,6,3"), "");
    EXPECT_EQ(board->peek(kTccr0a) & 0xC0, 0);
}

TEST(RequestsTest, Restart_TurnsEverythingOffAndKeepsAnswering) {
    FirmwareBoard board("asip_uno_services", "uno", {{"led", {{"pin", 13}}, "lamp"}});
    board.ask("I,P,13,3");
    board.ask("I,d,13,1");
    board.ask("I,A,10");
    board.ask("D,A,50");
    EXPECT_EQ(board->part("lamp").state(), "on");
    board->send("#,R\n");
    board->run_for(milliseconds(200));
    board->take_output();
    EXPECT_TRUE(board.lines_within(milliseconds(500)).empty());
    EXPECT_FALSE(board->is_output(13));
    EXPECT_EQ(board.ask("I,p"), "@I,p,20,{6,6,1,1,1,1,1,7,7,7,7,1,1,1,4,4,4,4,4,4}");
    EXPECT_EQ(board->resets(), 0u);
}

// What terminals send for the key Return, and what a wire or a program leaves before a request.
TEST(RequestsTest, EachLineEnd_EndsOneRequestAtOnce) {
    FirmwareBoard board("asip_uno_serial");
    board->reset();
    board->run_for(milliseconds(200));
    board->send("I,A,0\n");
    board->run_for(milliseconds(100));
    board->take_output();
    for (const std::string end : {"\r", "\n", "\r\n", "\n\r"})
        for (const std::string& before : {std::string(), std::string(" \0\t", 3)}) {
            board->send(before + "#,?" + end);
            EXPECT_EQ(board.next_line(milliseconds(20)), "@#,?,0,4,ATmega328P,20,AsipPlainSerial");
            board->send(before + "I,P,13,3" + end + before + "I,d,13,1" + end);
            board->run_for(milliseconds(10));
            EXPECT_EQ(board->pin(13), sim::Level::kHigh);
            board->send("I,d,13,0" + end);
            board->run_for(milliseconds(10));
            EXPECT_EQ(board->pin(13), sim::Level::kLow);
        }
    EXPECT_EQ(board.lines_within(milliseconds(1200)), std::vector<std::string>());
}

TEST(RequestsTest, SlowBytes_HoldNothingUp) {
    FirmwareBoard board("asip_uno", "uno",
                        {{"button", {{"pin", 4}, {"to_vcc", true}, {"steady", true}}, "button"}});
    for (char c : std::string("I,P,13,3")) {
        board->send(std::string(1, c));
        board->run_for(milliseconds(300));
        ASSERT_TRUE(board->part("button").command("press", ""));
        EXPECT_EQ(board.next_line(milliseconds(2)), "@I,d,4,10");
        ASSERT_TRUE(board->part("button").command("release", ""));
        EXPECT_EQ(board.next_line(milliseconds(2)), "@I,d,4,0");
    }
    EXPECT_FALSE(board->is_output(13));
    board->send("\n");
    board->run_for(milliseconds(1));
    EXPECT_TRUE(board->is_output(13));
}

}  // namespace
}  // namespace asip::firmware
