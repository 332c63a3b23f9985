// SPDX-License-Identifier: Apache-2.0
#include "sim/wiring/part_plan.hpp"

#include <gmock/gmock.h>

#include <set>

namespace asip::sim {
namespace {

std::string fault(std::vector<PartConfig> parts, const std::string& board = "uno", char uart = 0) {
    BoardConfig config;
    config.board = board;
    config.uart = uart;
    config.parts = std::move(parts);
    const auto plans = plan_parts(config, *BoardKind::find(board));
    return plans ? "" : plans.error();
}

TEST(PartPlan, PinThatDoesNotExist_Refused) {
    EXPECT_EQ(fault({{"led", {{"pin", 13}}}, {"led", {{"pin", 20}}}}),
              "/parts/1/pin: there is no pin 20 on the uno (0 to 19, A0 to A5)");
    EXPECT_EQ(fault({{"led", {{"pin", 20}}}}, "mega"), "");
    EXPECT_EQ(fault({{"led", {{"pin", -1}}}}),
              "/parts/0/pin: there is no pin -1 on the uno (0 to 19, A0 to A5)");
    EXPECT_EQ(fault({{"led", {{"pin", "A9"}}}}),
              "/parts/0/pin: there is no pin A9 on the uno (0 to 19, A0 to A5)");
    EXPECT_EQ(fault({PartConfig{"led"}}), "/parts/0/pin: is missing");
}

TEST(PartPlan, PinWithTwoParts_RefusedByTheFirstOnesName) {
    EXPECT_EQ(fault({{"button", {{"pin", 2}}, "a"}, {"square-wave", {{"pin", 2}}, "b"}}),
              "/parts/1: b: pin 2 is taken by a");
    EXPECT_EQ(fault({{"led", {{"pin", 2}}}, {"servo", {{"pin", 2}}}}),
              "/parts/1: servo2: pin 2 is taken by led2");
    EXPECT_EQ(fault({{"ultrasonic", {{"trigger", 4}, {"echo", 5}}, "a"}, {"button", {{"pin", 5}}, "b"}}),
              "/parts/1: b: pin 5 is taken by a");
    EXPECT_EQ(fault({{"button", {{"pin", 2}}, "a"}, {"wire", {{"from", 3}, {"to", 2}}, "b"}}),
              "/parts/1: b: pin 2 is taken by a");
}

TEST(PartPlan, SerialPort_HasItsPins) {
    EXPECT_EQ(fault({{"led", {{"pin", 1}}}}), "/parts/0: led1: pin 1 is taken by the serial port");
    EXPECT_EQ(fault({{"led", {{"pin", 18}}}}, "mega", '1'),
              "/parts/0: led18: pin 18 is taken by the serial port");
    EXPECT_EQ(fault({{"led", {{"pin", 1}}}}, "mega", '1'), "");
}

TEST(PartPlan, WireAndListeners_ShareAPin) {
    EXPECT_EQ(fault({{"led", {{"pin", 13}}},
                     {"wire", {{"from", 13}, {"to", 2}}, "b"},
                     {"wire", {{"from", 13}, {"to", 3}}, "c"}}),
              "");
}

TEST(PartPlan, ValuesThatCannotBe_Refused) {
    const auto fault_of = [](nlohmann::json input) {
        return fault({{"values", {{"inputs", nlohmann::json::array({std::move(input)})}}, "a"}});
    };
    EXPECT_EQ(fault({{"values", nlohmann::json::object(), "a"}}),
              "/parts/0: has neither \"inputs\" nor \"outputs\"");
    EXPECT_EQ(fault_of({{"pin", 2}}), "/parts/0/inputs/0/name: is missing");
    EXPECT_EQ(fault_of({{"name", "a,b"}, {"pin", 2}}),
              "/parts/0/inputs/0/name: has a space, a comma or \"=\" in it");
    EXPECT_EQ(fault_of({{"name", "x"}}), "/parts/0/inputs/0/pin: is missing");
    EXPECT_EQ(fault_of({{"name", "x"}, {"pin", "A0"}, {"max", 0}}),
              "/parts/0/inputs/0/max: must be above min");
    EXPECT_EQ(fault_of({{"name", "x"}, {"pin", 2}, {"value", 7}}),
              "/parts/0/inputs/0/value: on a digital pin it is min or max");
    EXPECT_NE(fault_of({{"name", "x"}, {"pin", 2}, {"colour", 7}}), "");
    EXPECT_EQ(fault_of({{"name", "x"}, {"pin", 1}}), "/parts/0: a: pin 1 is taken by the serial port");
}

TEST(PartPlan, PotentiometerOnDigitalPin_Refused) {
    EXPECT_EQ(fault({{"potentiometer", {{"pin", 13}}, "a"}}),
              "/parts/0: a: pin 13 of the uno is not an analog input");
    EXPECT_EQ(fault({{"potentiometer", {{"pin", 62}}, "a"}}, "mega"),
              "/parts/0: a: simavr cannot read pin 62: it has only the first 8 analog channels");
}

TEST(PartPlan, SameNameTwice_Refused) {
    EXPECT_EQ(fault({{"led", {{"pin", 13}}, "a"}, {"led", {{"pin", 12}}, "a"}}),
              "/parts/1: a: another part has this name");
    EXPECT_EQ(fault({{"led", {{"pin", 13}}, "a b"}}),
              "/parts/0/name: a part's name has no spaces and no \"/\" in it");
}

TEST(PartPlan, NoName_IsKindAndFirstPin) {
    BoardConfig config;
    config.parts = {{"led", {{"pin", 13}}}, {"wire", {{"from", "A0"}, {"to", 5}}}};
    const auto plans = plan_parts(config, *BoardKind::find("uno"));
    ASSERT_TRUE(plans) << plans.error();
    EXPECT_EQ((*plans)[0].name, "led13");
    EXPECT_EQ((*plans)[1].name, "wire14");
}

TEST(PartPlan, UnknownKindOrSetting_NamesTheNearest) {
    EXPECT_EQ(fault({{"buton", {{"pin", 2}}}}),
              "/parts/0/kind: there is no part \"buton\" (did you mean \"button\"?); one of led, button, "
              "wire, potentiometer, ultrasonic, dht, ds18b20, servo, stepper, square-wave, pixels, mpu6050, "
              "hmc5883l, bmp085, bme280, bh1750, sht31, sh1106, ssd1306, ads1115, pca9685, registers, "
              "mcp3008, values, "
              "rover");
    EXPECT_EQ(fault({{"led", {{"pin", 2}, {"active-low", true}}}}),
              "/parts/0/active-low: is unknown (did you mean \"active_low\"?)");
    EXPECT_EQ(fault({{"potentiometer", {{"pin", "A0"}, {"position", 2}}}}),
              "/parts/0/position: 2 is not a number from 0 to 1");
}

TEST(PartPlan, MoreTimedPartsThanTimers_Refused) {
    std::vector<PartConfig> parts;
    for (int pin = 2; pin < 2 + 33; ++pin)
        parts.push_back({"square-wave", {{"pin", pin}}});
    EXPECT_EQ(fault(parts, "mega"),
              "/parts/32: square-wave34: the parts of one board need more than 32 timers");
    parts.pop_back();
    EXPECT_EQ(fault(parts, "mega"), "");
}

TEST(PartKind, All_HaveNamesAndVerbsOfTheirOwn) {
    std::set<std::string_view> names;
    for (const auto* kind : PartKind::all()) {
        EXPECT_TRUE(names.insert(kind->name).second) << kind->name;
        EXPECT_EQ(PartKind::find(kind->name), kind);
        for (const auto& verb : kind->verbs)
            EXPECT_FALSE(verb.help.empty()) << kind->name << " " << verb.name;
    }
    EXPECT_EQ(PartKind::find("radio"), nullptr);
}

TEST(BoardKind, PinNames_AreTheSilkScreens) {
    const auto& uno = *BoardKind::find("uno");
    EXPECT_EQ(uno.parse_pin("13"), 13);
    EXPECT_EQ(uno.parse_pin("A5"), 19);
    EXPECT_EQ(BoardKind::find("mega")->parse_pin("A0"), 54);
    EXPECT_EQ(BoardKind::find("leonardo")->parse_pin("A0"), 18);
    for (const auto* wrong : {"A6", "20", "", "A", "-1", "13x", "1.5", "99999999999999999999"})
        EXPECT_FALSE(uno.parse_pin(wrong)) << wrong;
}

TEST(BoardKind, Tables_HaveThePinsOfTheBoards) {
    EXPECT_EQ(BoardKind::find("uno")->pins.size(), 20u);
    EXPECT_EQ(BoardKind::find("mega")->pins.size(), 70u);
    EXPECT_EQ(BoardKind::find("leonardo")->pins.size(), 24u);
    EXPECT_EQ(BoardKind::find("mega")->pins[13].port, 'B');
    EXPECT_EQ(BoardKind::find("mega")->pins[13].bit, 7);
    EXPECT_EQ(BoardKind::find("mega")->pins[69].channel, 15);
    EXPECT_EQ(BoardKind::find("leonardo")->pins[13].port, 'C');
    EXPECT_EQ(BoardKind::find("leonardo")->pins[12].channel, 9);
    EXPECT_EQ(BoardKind::find("due"), nullptr);
}

}  // namespace
}  // namespace asip::sim
