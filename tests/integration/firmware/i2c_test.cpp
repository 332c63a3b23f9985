// SPDX-License-Identifier: Apache-2.0
// The services on the I2C bus, with simulated chips: what they report, and what happens without them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "firmware_board.hpp"

namespace asip::firmware {
namespace {

using namespace std::chrono_literals;

const std::vector<sim::PartConfig> kChips = {
    {"mpu6050",
     {{"ax", 12}, {"ay", -340}, {"az", 16384}, {"gx", 1}, {"gy", -32768}, {"gz", 32767}},
     "motion"},
    {"hmc5883l", {{"x", 100}, {"y", -20}, {"z", 30}}, "compass"},
    {"bmp085", {{"pressure", 699.64}, {"temperature", 15.0}}, "barometer"}};

class ImuBoard : public FirmwareBoard {
  public:
    explicit ImuBoard(std::vector<sim::PartConfig> parts = kChips, const std::string& kind = "uno")
        : FirmwareBoard("asip_" + kind + "_imu", kind, std::move(parts)) {
        sim().run_for(20ms);  // the chips were found
    }

    /// The event that answers a request, which may come after the fence, or the error.
    std::string measure(const std::string& request) {
        const auto at_once = ask(request);
        return at_once.empty() ? next_line(200ms) : at_once;
    }
    void set(const std::string& part, const std::string& verb, const std::string& argument = "") {
        const auto done = sim().part(part).command(verb, argument);
        ASSERT_TRUE(done) << done.error();
    }
};

TEST(ImuTest, Services_AreNamedAndOwnTheBus) {
    ImuBoard board;
    EXPECT_EQ(board.ask("#,N"), "@#,N,5,{I:ASIP core IO,A:Accelerometer,G:Gyro,H:Heading,P:Pressure}");
    EXPECT_EQ(board.ask("#,S"), "@#,S,20,{@,@,I,I,I,I,I,I,I,I,I,I,I,I,I,I,I,I,A,A}");
    for (const char* request : {"I,P,18,3", "I,P,19,4"})
        EXPECT_EQ(board.ask(request), "~I,P,9{I2C_NOT_ENABLED}") << request;
    EXPECT_EQ(board.ask("I,d,18,1"), "~I,d,9{I2C_NOT_ENABLED}");
    EXPECT_EQ(board.ask("I,a,19,1"), "~I,a,9{I2C_NOT_ENABLED}");
    EXPECT_EQ(board.measure("A,M"), "@A,e,3,{12,-340,16384}") << "the bus was not disturbed";
}

TEST(ImuTest, Measurements_AreWhatTheChipsMeasure) {
    ImuBoard board;
    EXPECT_EQ(board.measure("A,M"), "@A,e,3,{12,-340,16384}");
    EXPECT_EQ(board.measure("G,M"), "@G,e,3,{1,-32768,32767}");
    EXPECT_EQ(board.measure("H,M"), "@H,e,4,{100,-20,30,348}");
    // The values of the example in the chip's data sheet: 699.64 hPa and 15.0 degrees.
    EXPECT_EQ(board.measure("P,M").substr(0, 20), "@P,e,3,{699.64,15.00");
    board.set("motion", "set", "ax=-1,gz=5");
    EXPECT_EQ(board.measure("A,M"), "@A,e,3,{-1,-340,16384}");
    EXPECT_EQ(board.measure("G,M"), "@G,e,3,{1,-32768,5}");
}

TEST(ImuTest, Heading_IsTheAngleOfTheField) {
    ImuBoard board;
    struct {
        const char* field;
        int degrees;
    } const cases[] = {{"x=100,y=0", 0},      {"x=100,y=100", 45}, {"x=0,y=100", 90},
                       {"x=-100,y=100", 135}, {"x=-100,y=0", 180}, {"x=-100,y=-100", 225},
                       {"x=0,y=-100", 270},   {"x=100,y=-1", 360}};
    for (const auto& one : cases) {
        board.set("compass", "set", one.field);
        int x = 0, y = 0, z = 0, degrees = -1;
        const auto line = board.measure("H,M");
        ASSERT_EQ(std::sscanf(line.c_str(), "@H,e,4,{%d,%d,%d,%d}", &x, &y, &z, &degrees), 4) << line;
        EXPECT_GE(degrees, 0);
        EXPECT_LE(degrees, 359);
        EXPECT_LE(std::min((degrees - one.degrees + 360) % 360, (one.degrees - degrees + 360) % 360), 1)
            << line;
    }
}

TEST(ImuTest, Pressure_FollowsTheChipAndKnowsTheAltitude) {
    ImuBoard board;
    for (const double pressure : {1013.25, 1085.0, 900.0, 500.0, 310.0}) {
        for (const double temperature : {-20.0, 0.0, 24.3, 60.0}) {
            board.set("barometer", "set",
                      "pressure=" + std::to_string(pressure) + ",temperature=" + std::to_string(temperature));
            const auto line = board.measure("P,M");
            double hectopascals = 0, degrees = 0, metres = 0;
            ASSERT_EQ(std::sscanf(line.c_str(), "@P,e,3,{%lf,%lf,%lf}", &hectopascals, &degrees, &metres), 3)
                << line;
            EXPECT_NEAR(hectopascals, pressure, 0.15) << line;
            EXPECT_NEAR(degrees, temperature, 0.11) << line;
            EXPECT_NEAR(metres, 44330 * (1 - std::pow(hectopascals / 1013.25, 0.190295)), 0.05) << line;
        }
    }
}

TEST(ImuTest, Reports_ComeAtTheirPeriodFromAllFour) {
    ImuBoard board;
    board.step_up(500000);
    for (const char* request : {"A,A,50", "G,A,50", "H,A,50", "P,A,50"})
        EXPECT_EQ(board.ask(request), "");
    std::map<char, int> count;
    for (const auto& line : board.lines_within(1000ms))
        ++count[line[1]];
    for (const char service : {'A', 'G', 'H', 'P'})
        EXPECT_NEAR(count[service], 20, 1) << service;
}

TEST(ImuTest, BadRequests_AreReported) {
    ImuBoard board;
    for (const char service : {'A', 'G', 'H', 'P'}) {
        const std::string start{service, ','};
        EXPECT_EQ(board.ask(start + "M,1"), "~" + start + "M,11{BAD_ARGUMENT}");
        EXPECT_EQ(board.ask(start + "A"), "~" + start + "A,11{BAD_ARGUMENT}");
        EXPECT_EQ(board.ask(start + "A,x"), "~" + start + "A,11{BAD_ARGUMENT}");
        EXPECT_EQ(board.ask(start + "x"), "~" + start + "x,2{UNKNOWN_REQUEST}");
    }
}

TEST(ImuTest, ChipThatIsMissing_IsAnErrorAndTheOthersWork) {
    ImuBoard board({{"hmc5883l", nlohmann::json::object(), "compass"}});
    for (const char service : {'A', 'G', 'P'}) {
        const std::string start{service, ','};
        EXPECT_EQ(board.ask(start + "M"), "~" + start + "M,8{DEVICE_NOT_AVAILABLE}");
        EXPECT_EQ(board.ask(start + "A,50"), "~" + start + "A,8{DEVICE_NOT_AVAILABLE}");
    }
    EXPECT_EQ(board.measure("H,M").substr(0, 8), "@H,e,4,{");
    EXPECT_TRUE(board.lines_within(200ms).empty());
}

TEST(ImuTest, ChipThatComesBack_IsFoundByTheNextRequestAndReportsGoOn) {
    ImuBoard board;
    board.ask("A,A,20");
    EXPECT_EQ(board.next_line(), "@A,e,3,{12,-340,16384}");
    board.set("motion", "detach");
    board.lines_within(50ms);
    EXPECT_TRUE(board.lines_within(100ms).empty());
    EXPECT_EQ(board.ask("A,M"), "~A,M,8{DEVICE_NOT_AVAILABLE}");
    board.set("motion", "attach");
    EXPECT_EQ(board.next_line(50ms), "@A,e,3,{12,-340,16384}");
    board.ask("G,M");
    board->run_for(20ms);
    EXPECT_EQ(board.ask("A,A,0").find("~"), std::string::npos);
}

TEST(ImuTest, ChipThatGoesDuringAMeasurement_IsAnErrorInPlaceOfTheValue) {
    ImuBoard board;
    board.set("barometer", "detach");
    EXPECT_EQ(board.measure("P,M"), "~P,e,8{DEVICE_NOT_AVAILABLE}");
    EXPECT_EQ(board.measure("P,M"), "~P,M,8{DEVICE_NOT_AVAILABLE}");
}

TEST(ImuTest, StuckBus_IsAnErrorAndTheBoardGoesOn) {
    auto parts = kChips;
    parts.push_back({"button", {{"pin", 18}, {"steady", true}}, "short"});
    ImuBoard board(parts);
    EXPECT_EQ(board.measure("A,M"), "@A,e,3,{12,-340,16384}");
    board.set("short", "press");
    EXPECT_EQ(board.measure("A,M"), "~A,e,8{DEVICE_NOT_AVAILABLE}");
    const auto before = board->now();
    EXPECT_EQ(board.ask("#,E,here"), "@#,E,here");
    EXPECT_LT(board->now() - before, 10ms);
    board.set("short", "release");
    board.ask("A,M");
    board->run_for(50ms);
    EXPECT_EQ(board.measure("A,M"), "@A,e,3,{12,-340,16384}");
}

TEST(ImuTest, ResetInTheMiddleOfATransfer_FreesTheBus) {
    ImuBoard board;
    for (int i = 0; i < 40; ++i) {
        board->send("A,M\n");
        board->run_for(1ms + 50us * i);
        board->reset();
        board.next_line();  // the banner
        board.ask("I,A,0");
        board->run_for(50ms);
        board->take_output();
        ASSERT_EQ(board.measure("A,M"), "@A,e,3,{12,-340,16384}") << i;
    }
}

TEST(ImuTest, RestartInTheMiddleOfAMeasurement_BeginsAnew) {
    ImuBoard board;
    for (int i = 0; i < 20; ++i) {
        board->send("P,M\nA,M\n");
        board->run_for(1ms + 300us * i);
        board.ask("#,R");
        board->run_for(100ms);
        board->take_output();
        ASSERT_EQ(board.measure("G,M"), "@G,e,3,{1,-32768,32767}") << i;
        ASSERT_EQ(board.measure("P,M").substr(0, 20), "@P,e,3,{699.64,15.00") << i;
    }
}

TEST(ImuTest, ChipsUnderAFloodOfBadRequests_StillMeasure) {
    ImuBoard board;
    board.step_up(500000);
    board.ask("A,A,20");
    int reports = 0, errors = 0;
    for (int i = 0; i < 100; ++i) {
        for (int k = 0; k < 8; ++k)
            board->send("Z,x\n");
        for (const auto& line : board.lines_within(10ms)) {
            reports += line == "@A,e,3,{12,-340,16384}";
            errors += line == "~Z,?,1{INVALID_SERVICE}";
        }
    }
    EXPECT_NEAR(reports, 50, 2);
    EXPECT_EQ(errors, 800);
    EXPECT_EQ(board->line_errors().receive_overruns, 0u);
}

class ImuBoardsTest : public testing::TestWithParam<const char*> {};

TEST_P(ImuBoardsTest, Measurements_WorkOnTheBoardsOwnPins) {
    ImuBoard board(kChips, GetParam());
    EXPECT_EQ(board.measure("A,M"), "@A,e,3,{12,-340,16384}");
    EXPECT_EQ(board.measure("P,M").substr(0, 20), "@P,e,3,{699.64,15.00");
}

INSTANTIATE_TEST_SUITE_P(All, ImuBoardsTest, testing::Values("mega", "1284p"));

}  // namespace
}  // namespace asip::firmware
