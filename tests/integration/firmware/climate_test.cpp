// SPDX-License-Identifier: Apache-2.0
// Sensors of temperature and humidity: what they report, and what happens when they fail.
#include <gtest/gtest.h>

#include <cstdio>

#include "firmware_board.hpp"

namespace asip::firmware {
namespace {

using namespace std::chrono_literals;

std::vector<sim::PartConfig> two_sensors() {
    return {{"dht", {{"pin", 10}, {"temperature", 21.5}, {"humidity", 45.2}}, "room"},
            {"dht", {{"pin", 11}, {"temperature", -10.1}, {"humidity", 100}}, "cellar"}};
}

class ClimateBoard : public FirmwareBoard {
  public:
    explicit ClimateBoard(std::vector<sim::PartConfig> parts = two_sensors(), const std::string& kind = "uno",
                          std::uint32_t frequency = 16'000'000)
        : FirmwareBoard("asip_" + kind + "_climate", kind == "mega" ? "mega" : "uno", std::move(parts),
                        frequency) {}

    std::string measure() {
        EXPECT_EQ(ask("C,M"), "");
        return next_line(6000ms);
    }
    void tell(const std::string& part, const std::string& verb, const std::string& argument = "") {
        const auto done = sim().part(part).command(verb, argument);
        ASSERT_TRUE(done) << done.error();
    }
};

TEST(ClimateTest, Service_IsNamedAndOwnsItsPins) {
    ClimateBoard board;
    EXPECT_EQ(board.ask("#,N"), "@#,N,2,{I:ASIP core IO,C:Climate}");
    EXPECT_EQ(board.ask("#,S"), "@#,S,20,{@,@,I,I,I,I,I,I,I,I,C,C,I,I,I,I,I,I,I,I}");
    EXPECT_EQ(board.ask("I,P,10,1"), "~I,P,4{MODE_UNAVAILABLE}");
}

TEST(ClimateTest, Measurements_AreWhatTheSensorsMeasure) {
    ClimateBoard board;
    EXPECT_EQ(board.measure(), "@C,e,2,{21.50:45.20,-10.10:100.00}");
    // The values of the example in the data sheet.
    board.tell("room", "set", "temperature=35.1,humidity=65.2");
    board.tell("cellar", "set", "temperature=-0.1,humidity=0");
    board->run_for(6s);
    EXPECT_EQ(board.measure(), "@C,e,2,{35.10:65.20,-0.10:0.00}");
    EXPECT_EQ(board.ask("C,E"), "@C,E,2,{0:0,0:0}");
}

TEST(ClimateTest, EveryValue_IsReadBitForBit) {
    ClimateBoard board;
    for (int tenths = -400; tenths <= 800; tenths += 173) {
        const int humidity = (tenths + 400) * 5 / 6;
        char values[64], expected[64];
        std::snprintf(values, sizeof values, "temperature=%.1f,humidity=%.1f", tenths / 10.0,
                      humidity / 10.0);
        std::snprintf(expected, sizeof expected, "@C,e,2,{%.2f:%.2f,", tenths / 10.0, humidity / 10.0);
        board.tell("room", "set", values);
        board->run_for(6s);
        EXPECT_EQ(board.measure().find(expected), 0u) << values;
    }
}

TEST(ClimateTest, ValueAfterAPause_IsNotThatOfBeforeThePause) {
    ClimateBoard board;
    board.measure();
    board.tell("room", "set", "temperature=30");
    board->run_for(60s);
    EXPECT_EQ(board.measure(), "@C,e,2,{30.00:45.20,-10.10:100.00}");
}

TEST(ClimateTest, Reports_ComeAtTheirPeriodAndFollow) {
    ClimateBoard board;
    board.ask("C,A,3000");
    auto lines = board.lines_within(16s);
    ASSERT_GE(lines.size(), 4u);
    for (const auto& line : lines)
        EXPECT_EQ(line, "@C,e,2,{21.50:45.20,-10.10:100.00}");
    board.tell("room", "set", "temperature=22");
    lines = board.lines_within(7s);
    EXPECT_EQ(lines.back(), "@C,e,2,{22.00:45.20,-10.10:100.00}");
    board.ask("C,A,100");
    EXPECT_NEAR(static_cast<double>(board.lines_within(10s).size()), 5, 1) << "no sensor is asked more often";
}

TEST(ClimateTest, DamagedAnswer_IsNoValueAndCounted) {
    ClimateBoard board;
    EXPECT_EQ(board.measure(), "@C,e,2,{21.50:45.20,-10.10:100.00}");
    board.tell("room", "damage", "1");
    EXPECT_EQ(board.measure(), "@C,e,2,{,-10.10:100.00}");
    EXPECT_EQ(board.ask("C,E"), "@C,E,2,{1:0,0:0}");
    EXPECT_EQ(board.measure(), "@C,e,2,{21.50:45.20,-10.10:100.00}");
    board.tell("cellar", "damage", "3");
    for (int i = 0; i < 3; ++i)
        EXPECT_EQ(board.measure(), "@C,e,2,{21.50:45.20,}");
    EXPECT_EQ(board.ask("C,E"), "@C,E,2,{1:0,3:0}");
}

TEST(ClimateTest, SensorThatIsPulledOut_HasNoValueUntilItIsBack) {
    ClimateBoard board;
    board.ask("C,A,2500");
    EXPECT_EQ(board.next_line(8000ms), "@C,e,2,{21.50:45.20,-10.10:100.00}");
    board.tell("cellar", "detach");
    EXPECT_EQ(board.next_line(8000ms), "@C,e,2,{21.50:45.20,}");
    EXPECT_EQ(board.next_line(8000ms), "@C,e,2,{21.50:45.20,}");
    board.tell("cellar", "attach");
    EXPECT_EQ(board.next_line(8000ms), "@C,e,2,{21.50:45.20,-10.10:100.00}");
    EXPECT_EQ(board.ask("C,E"), "@C,E,2,{0:0,0:2}");
}

TEST(ClimateTest, SensorThatIsPulledOutInTheMiddle_IsDamaged) {
    ClimateBoard board;
    board.measure();
    board.ask("C,M");
    bool told = false;
    for (int i = 0; i < 30000 && !told; ++i) {
        board->run_for(100us);
        if (board->pin(10) == sim::Level::kLow) {
            board->run_for(3500us);  // the low of the board, and about 15 bits
            board.tell("room", "detach");
            told = true;
        }
    }
    EXPECT_EQ(board.next_line(6000ms), "@C,e,2,{,-10.10:100.00}");
    EXPECT_EQ(board.ask("C,E"), "@C,E,2,{1:0,0:0}");
}

TEST(ClimateTest, NoSensorAtAll_HasNoValueAndTheBoardGoesOn) {
    ClimateBoard board(std::vector<sim::PartConfig>{});
    board.ask("C,M");
    EXPECT_EQ(board.ask("#,E,here"), "@#,E,here");
    EXPECT_EQ(board.next_line(6000ms), "@C,e,2,{,}");
}

TEST(ClimateTest, BadRequests_AreReported) {
    ClimateBoard board;
    EXPECT_EQ(board.ask("C,M,1"), "~C,M,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("C,E,1"), "~C,E,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("C,A"), "~C,A,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("C,x"), "~C,x,2{UNKNOWN_REQUEST}");
    EXPECT_EQ(board.measure(), "@C,e,2,{21.50:45.20,-10.10:100.00}");
}

TEST(ClimateTest, RestartInTheMiddle_BeginsAnew) {
    ClimateBoard board;
    board.measure();
    for (int i = 0; i < 6; ++i) {
        board.ask("C,M");
        board->run_for(1990ms + 2ms * i);
        board.ask("#,R");
        board->run_for(3s);
        board->take_output();
        ASSERT_EQ(board.measure(), "@C,e,2,{21.50:45.20,-10.10:100.00}") << i;
    }
}

TEST(ClimateTest, RequestsAt1000000BaudMeanwhile_LoseNoByteAndDamageNoAnswer) {
    ClimateBoard board;
    board.step_up(1000000);
    board.ask("C,A,2000");
    int reports = 0, answers = 0, sent = 0;
    for (int i = 0; i < 3000; ++i) {
        for (int k = 0; k < 8; ++k, ++sent)
            board->send("Z,x\n");
        for (const auto& line : board.lines_within(3ms)) {
            reports += line == "@C,e,2,{21.50:45.20,-10.10:100.00}";
            answers += line == "~Z,?,1{INVALID_SERVICE}";
        }
    }
    EXPECT_GE(reports, 3);
    EXPECT_EQ(answers, sent);
    EXPECT_EQ(board->line_errors().receive_overruns, 0u);
    EXPECT_EQ(board.ask("C,E"), "@C,E,2,{0:0,0:0}");
}

TEST(ClimateTest, OtherBoards_MeasureOnPinsWithAnInterrupt) {
    ClimateBoard mega(two_sensors(), "mega");
    EXPECT_EQ(mega.measure(), "@C,e,2,{21.50:45.20,-10.10:100.00}");
    FirmwareBoard port_k("asip_mega_dht_on_a8", "mega",
                         {{"dht", {{"pin", "A8"}, {"temperature", 21.5}, {"humidity", 45.2}}, "room"},
                          {"dht", {{"pin", "A15"}, {"temperature", -10.1}, {"humidity", 100}}, "cellar"}});
    port_k.ask("C,M");
    EXPECT_EQ(port_k.next_line(6000ms), "@C,e,2,{21.50:45.20,-10.10:100.00}");
    ClimateBoard slow(two_sensors(), "mini8", 8'000'000);
    EXPECT_EQ(slow.measure(), "@C,e,2,{21.50:45.20,-10.10:100.00}");
}

TEST(Dht11Test, WholeDegreesAndTenths_AreRead) {
    FirmwareBoard board(
        "asip_uno_dht11", "uno",
        {{"dht", {{"pin", 4}, {"dht11", true}, {"temperature", 23.4}, {"humidity", 51}}, "room"}});
    for (const auto& [set, expected] : {std::pair{"temperature=23.4", "@C,e,1,{23.40:51.00}"},
                                        {"temperature=-5", "@C,e,1,{-5.00:51.00}"}}) {
        ASSERT_TRUE(board->part("room").command("set", set));
        board->run_for(6s);
        board.ask("C,M");
        EXPECT_EQ(board.next_line(6000ms), expected);
    }
}

}  // namespace
}  // namespace asip::firmware
