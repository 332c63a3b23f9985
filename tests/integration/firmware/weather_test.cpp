// SPDX-License-Identifier: Apache-2.0
// Sensors of the weather on the I2C bus: what they report, and what happens when they fail.
#include <gtest/gtest.h>

#include <cstdio>

#include "firmware_board.hpp"

namespace asip::firmware {
namespace {

using namespace std::chrono_literals;

class WeatherBoard : public FirmwareBoard {
  public:
    explicit WeatherBoard(const nlohmann::json& settings = {{"temperature", 21.5}, {"humidity", 45}})
        : FirmwareBoard("asip_uno_weather", "uno", {{"bme280", settings, "air"}}) {
        sim().run_for(20ms);  // the chip was found
    }

    /// The event that answers W,M, which may come after the fence, or the error.
    std::string measure() {
        const auto at_once = ask("W,M");
        return at_once.empty() ? next_line(200ms) : at_once;
    }
    void tell(const std::string& verb, const std::string& argument = "") {
        const auto done = sim().part("air").command(verb, argument);
        ASSERT_TRUE(done) << done.error();
    }
};

struct Air {
    double temperature = 0, humidity = 0, pressure = 0;
};
Air read(const std::string& line) {
    Air air;
    EXPECT_EQ(
        std::sscanf(line.c_str(), "@W,e,3,{%lf,%lf,%lf}", &air.temperature, &air.humidity, &air.pressure), 3)
        << line;
    return air;
}

TEST(WeatherTest, Service_IsNamedAndOwnsTheBus) {
    WeatherBoard board;
    EXPECT_EQ(board.ask("#,N"), "@#,N,2,{I:ASIP core IO,W:Weather}");
    EXPECT_EQ(board.ask("I,P,18,3"), "~I,P,9{I2C_NOT_ENABLED}");
}

TEST(WeatherTest, ExampleOfTheDataSheet_IsConverted) {
    WeatherBoard board(nlohmann::json{{"temperature", 25.0825}, {"pressure", 1006.5327}, {"bmp280", true}});
    EXPECT_EQ(board.measure(), "@W,e,3,{25.08,,1006.56}") << "in 32 bits: 3 Pa above the example in 64";
}

TEST(WeatherTest, Measurements_FollowTheChip) {
    WeatherBoard board;
    for (const double temperature : {-40.0, -10.0, 0.0, 21.5, 85.0}) {
        for (const double humidity : {0.0, 12.0, 45.0, 100.0}) {
            for (const double pressure : {300.0, 700.0, 1013.25, 1100.0}) {
                char values[96];
                std::snprintf(values, sizeof values, "temperature=%.2f,humidity=%.2f,pressure=%.2f",
                              temperature, humidity, pressure);
                board.tell("set", values);
                const auto air = read(board.measure());
                EXPECT_NEAR(air.temperature, temperature, 0.011) << values;
                EXPECT_NEAR(air.humidity, humidity, 0.06) << values;
                EXPECT_NEAR(air.pressure, pressure, 0.1) << values;
            }
        }
    }
}

TEST(WeatherTest, ChipAtTheOtherAddress_IsAnError) {
    WeatherBoard board(nlohmann::json{{"address", 0x77}});
    EXPECT_EQ(board.measure(), "~W,M,8{DEVICE_NOT_AVAILABLE}");
    EXPECT_EQ(board.ask("W,A,50"), "~W,A,8{DEVICE_NOT_AVAILABLE}");
}

TEST(WeatherTest, ChipThatIsPulledOutAndPutBack_ReportsAgain) {
    WeatherBoard board;
    EXPECT_EQ(board.ask("W,A,50"), "");
    EXPECT_EQ(board.next_line().substr(0, 12), "@W,e,3,{21.5");
    board.tell("detach");
    board.lines_within(100ms);
    EXPECT_TRUE(board.lines_within(300ms).empty()) << "no value is repeated";
    EXPECT_EQ(board.measure(), "~W,M,8{DEVICE_NOT_AVAILABLE}");
    board.tell("attach");
    EXPECT_EQ(board.next_line().substr(0, 12), "@W,e,3,{21.5");
}

TEST(WeatherTest, ChipThatLostItsPowerMeanwhile_HasMeasuredNothing) {
    WeatherBoard board;
    EXPECT_EQ(board.ask("W,M"), "");
    board->run_for(5ms);
    board.tell("detach");
    board.tell("attach");
    EXPECT_EQ(board.next_line(), "~W,e,8{DEVICE_NOT_AVAILABLE}");
    board->run_for(20ms);
    board.ask("W,M");  // looks for it again
    board->run_for(50ms);
    board->take_output();
    EXPECT_EQ(board.measure().substr(0, 12), "@W,e,3,{21.5");
}

TEST(WeatherTest, BadRequests_AreReported) {
    WeatherBoard board;
    EXPECT_EQ(board.ask("W,M,1"), "~W,M,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("W,A"), "~W,A,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("W,x"), "~W,x,2{UNKNOWN_REQUEST}");
    EXPECT_EQ(board.measure().substr(0, 12), "@W,e,3,{21.5");
}

TEST(WeatherTest, RequestsAt1000000BaudMeanwhile_LoseNoByte) {
    WeatherBoard board;
    board.step_up(1000000);
    board.ask("W,A,50");
    int reports = 0, answers = 0, sent = 0;
    for (int i = 0; i < 500; ++i) {
        for (int k = 0; k < 8; ++k, ++sent)
            board->send("Z,x\n");
        for (const auto& line : board.lines_within(3ms)) {
            reports += line.substr(0, 12) == "@W,e,3,{21.5";
            answers += line == "~Z,?,1{INVALID_SERVICE}";
        }
    }
    EXPECT_GE(reports, 20);
    EXPECT_EQ(answers, sent);
    EXPECT_EQ(board->line_errors().receive_overruns, 0u);
}

}  // namespace
}  // namespace asip::firmware
