// SPDX-License-Identifier: Apache-2.0
// An SHT31 and a BH1750 on one I2C bus: what they report, and what happens when they fail.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <tuple>

#include "firmware_board.hpp"

namespace asip::firmware {
namespace {

using namespace std::chrono_literals;

class RoomBoard : public FirmwareBoard {
  public:
    explicit RoomBoard(const nlohmann::json& air = {{"temperature", 21.5}, {"humidity", 45}},
                       const nlohmann::json& light = {{"lux", 347.5}},
                       const std::string& image = "asip_uno_room", std::uint32_t frequency = 16'000'000)
        : FirmwareBoard(image, "uno", {{"sht31", air, "air"}, {"bh1750", light, "light"}}, frequency) {
        sim().run_for(20ms);  // the chips were found
    }

    /// The event that answers a request, which may come after the fence, or the error.
    std::string answer(const std::string& request) {
        const auto at_once = ask(request);
        return at_once.empty() ? next_line(400ms) : at_once;
    }
    void tell(const std::string& part, const std::string& verb, const std::string& argument = "") {
        const auto done = sim().part(part).command(verb, argument);
        ASSERT_TRUE(done) << done.error();
    }
};

constexpr const char* kAir = "@Q,e,2,{21.50,45.00}";
constexpr const char* kLight = "@U,e,1,{347.50}";

TEST(RoomTest, Services_AreNamedAndMeasureAtOnce) {
    RoomBoard board;
    EXPECT_EQ(board.ask("#,N"), "@#,N,3,{I:ASIP core IO,Q:Hygrometer,U:Illuminance}");
    EXPECT_EQ(board.answer("Q,M"), kAir);
    EXPECT_EQ(board.answer("U,M"), kLight);
    board.ask("U,M");
    EXPECT_EQ(board.answer("Q,M"), kAir) << "while the other measures";
    EXPECT_EQ(board.next_line(), kLight);
}

TEST(RoomTest, Measurements_FollowTheChips) {
    RoomBoard board;
    for (const double temperature : {-40.0, -0.5, 0.0, 21.37, 125.0}) {
        for (const double humidity : {0.0, 33.3, 100.0}) {
            char values[64];
            std::snprintf(values, sizeof values, "temperature=%.2f,humidity=%.2f", temperature, humidity);
            board.tell("air", "set", values);
            double read[2] = {};
            const auto line = board.answer("Q,M");
            ASSERT_EQ(std::sscanf(line.c_str(), "@Q,e,2,{%lf,%lf}", &read[0], &read[1]), 2) << line;
            EXPECT_NEAR(read[0], temperature, 0.0101) << values;
            EXPECT_NEAR(read[1], humidity, 0.0101) << values;
        }
    }
    for (const double lux : {0.0, 0.84, 5.0, 1234.5, 54612.5, 100000.0}) {
        board.tell("light", "set", "lux=" + std::to_string(lux));
        double read = -1;
        const auto line = board.answer("U,M");
        ASSERT_EQ(std::sscanf(line.c_str(), "@U,e,1,{%lf}", &read), 1) << line;
        EXPECT_NEAR(read, std::min(lux, 54612.5), 0.84) << "a count is 0.83 lux";
    }
}

// The clock of a sketch goes on by two or three milliseconds at once on a chip of 8 MHz.
TEST(RoomTest, MeasurementAtAnyTime_WaitsForTheChip) {
    RoomBoard board({{"temperature", 21.5}, {"humidity", 45}}, {{"lux", 347.5}}, "asip_mini8_room",
                    8'000'000);
    for (int i = 0; i < 200; ++i) {
        board->run_for(73us * i % 2048us);
        ASSERT_EQ(board.answer("Q,M"), kAir) << i;
    }
}

TEST(RoomTest, DamagedMeasurement_HasNoValuesAndIsCounted) {
    RoomBoard board;
    EXPECT_EQ(board.ask("Q,E"), "@Q,E,1,{0}");
    EXPECT_EQ(board.answer("Q,M"), kAir);
    board.tell("air", "damage", "2");
    EXPECT_EQ(board.answer("Q,M"), "@Q,e,2,{,}") << "nothing of before is repeated";
    EXPECT_EQ(board.answer("Q,M"), "@Q,e,2,{,}");
    EXPECT_EQ(board.answer("Q,M"), kAir);
    EXPECT_EQ(board.ask("Q,E"), "@Q,E,1,{2}");
}

TEST(RoomTest, ChipAtTheOtherAddress_IsAnErrorOfItsServiceAlone) {
    RoomBoard board(nlohmann::json{{"address", 0x45}});
    EXPECT_EQ(board.answer("Q,M"), "~Q,M,8{DEVICE_NOT_AVAILABLE}");
    EXPECT_EQ(board.answer("U,M"), kLight);
    RoomBoard other(nlohmann::json{{"temperature", 21.5}, {"humidity", 45}},
                    nlohmann::json{{"address", 0x5c}});
    EXPECT_EQ(other.answer("U,M"), "~U,M,8{DEVICE_NOT_AVAILABLE}");
    EXPECT_EQ(other.answer("Q,M"), kAir);
}

TEST(RoomTest, ChipThatIsPulledOutAndPutBack_ReportsAgain) {
    RoomBoard board;
    for (const auto& [part, letter, value] :
         {std::tuple{"air", "Q", kAir}, std::tuple{"light", "U", kLight}}) {
        EXPECT_EQ(board.ask(std::string(letter) + ",A,300"), "");
        EXPECT_EQ(board.next_line(700ms), value);
        board.tell(part, "detach");
        board.lines_within(400ms);
        EXPECT_TRUE(board.lines_within(900ms).empty()) << "no value is repeated";
        board.tell(part, "attach");
        EXPECT_EQ(board.next_line(900ms), value);
        EXPECT_EQ(board.ask(std::string(letter) + ",A,0"), "");
    }
}

TEST(RoomTest, BadRequests_AreReported) {
    RoomBoard board;
    EXPECT_EQ(board.ask("Q,M,1"), "~Q,M,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("Q,E,1"), "~Q,E,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("U,x"), "~U,x,2{UNKNOWN_REQUEST}");
    EXPECT_EQ(board.answer("Q,M"), kAir);
}

}  // namespace
}  // namespace asip::firmware
