// SPDX-License-Identifier: Apache-2.0
// AsipEverything: fifteen services on a Mega, each with its part, at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "firmware_board.hpp"

namespace asip::firmware {
namespace {

using namespace std::chrono_literals;

std::vector<sim::PartConfig> parts() {
    return {{"dht", {{"pin", 10}, {"temperature", 19.5}, {"humidity", 60}}, "climate"},
            {"ds18b20", {{"pin", 22}, {"devices", {{{"number", 1}, {"temperature", 17.25}}}}}, "wire"},
            {"bme280", {{"temperature", 21.5}}, "weather"},
            {"sht31", {{"temperature", 22.5}, {"humidity", 45}}, "hygrometer"},
            {"bh1750", {{"lux", 347.5}}, "illuminance"},
            {"sh1106", nlohmann::json::object(), "lcd"},
            {"ultrasonic", {{"pin", 23}, {"distance", 42}}, "distance"},
            {"servo", {{"pin", 25}}, "servo"},
            {"stepper", {{"coils", {28, 29, 30, 31}}}, "dial"},
            {"stepper", {{"step", 32}, {"direction", 33}, {"enable", 34}}, "slide"}};
}

TEST(EverythingTest, EachService_WorksBesideAllOthers) {
    FirmwareBoard board("asip_mega_everything", "mega", parts());
    EXPECT_EQ(board.ask("#,N"),
              "@#,N,16,{I:ASIP core IO,C:Climate,K:Thermometers,O:OneWire,W:Weather,Q:Hygrometer,"
              "U:Illuminance,L:LCD,J:I2C,D:Distance,S:Servos,Y:Steppers,T:Tone,M:Motors,E:Encoders,"
              "N:NeoPixels}");
    board->run_for(3s);  // sensors were found, and rested
    for (const char* request :
         {"Y,G,0,1000", "Y,G,1,-300", "S,W,0,45", "T,P,440,500", "M,m,0,100", "L,W,0,Hello", "C,A,3000",
          "K,A,1000", "W,A,1000", "Q,A,1000", "U,A,1000", "D,A,1000"})
        EXPECT_EQ(board.ask(request).find('~'), std::string::npos) << request;
    std::set<std::string> seen;
    for (const auto& line : board.lines_within(7s))
        seen.insert(line);
    for (const char* line : {"@C,e,1,{19.50:60.00}", "@K,e,1,{17.25}", "@Q,e,2,{22.50,45.00}",
                             "@U,e,1,{347.50}", "@Y,e,2,{1000:0:0,-300:0:0}"})
        EXPECT_EQ(seen.count(line), 1u) << line;
    EXPECT_TRUE(std::any_of(seen.begin(), seen.end(),
                            [](const auto& line) { return line.starts_with("@W,e,3,{21.50,40.0"); }));
    // Without an interrupt at its pin an echo is timed to within a pass, which the others make longer.
    EXPECT_TRUE(std::any_of(seen.begin(), seen.end(), [](const auto& line) {
        return line >= "@D,e,2,{41,0}" && line <= "@D,e,2,{45,0}";
    }));
    for (const auto& line : seen)
        EXPECT_FALSE(line.starts_with('~')) << line;
    EXPECT_EQ(board->part("dial").state().substr(0, 5), "1000 ");
    EXPECT_EQ(board->part("slide").state(), "-300 on");
    EXPECT_NEAR(std::stod(board->part("servo").state()), 45, 1.5);
    EXPECT_EQ(board->part("lcd").state().substr(0, 7), "0:Hello");
}

}  // namespace
}  // namespace asip::firmware
