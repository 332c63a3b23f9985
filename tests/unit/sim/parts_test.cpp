// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "monitor.hpp"

namespace asip::sim {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr unsigned kPb5 = 1 << 5;
constexpr unsigned kPd2 = 1 << 2;
constexpr unsigned kPd3 = 1 << 3;

/// The values that parts went through.
void record(Monitor& monitor, std::vector<std::string>& values) {
    monitor->on_change(
        [&values](const Change& change) { values.push_back(change.part + " " + change.value); });
}

TEST(Led, OutputChanges_ShowsThemWithTheirTime) {
    Monitor monitor({{"led", {{"pin", 13}}, "led"}});
    std::vector<Change> changes;
    monitor->on_change([&](const Change& change) { changes.push_back(change); });
    EXPECT_EQ(monitor->part("led").state(), "off");
    monitor.write_register(kDdrB, kPb5);
    const auto before = monitor->now();
    monitor.write_register(kPortB, kPb5);
    EXPECT_EQ(monitor->part("led").state(), "on");
    monitor.write_register(kPortB, 0);
    ASSERT_EQ(changes.size(), 2u);
    EXPECT_EQ(changes[0].value, "on");
    EXPECT_EQ(changes[1].value, "off");
    EXPECT_GT(changes[0].time, before);
    EXPECT_LT(changes[0].time, changes[1].time);
}

TEST(Led, PinIsOnlyPulledUp_StaysOff) {
    Monitor monitor({{"led", {{"pin", 13}}, "led"}});
    monitor.write_register(kPortB, kPb5);
    EXPECT_EQ(monitor->part("led").state(), "off");
}

TEST(Led, ActiveLow_LitByALowPin) {
    Monitor monitor({{"led", {{"pin", 13}, {"active_low", true}}, "led"}});
    monitor.write_register(kDdrB, kPb5);
    EXPECT_EQ(monitor->part("led").state(), "on");
}

TEST(Led, Pwm_ShowsItsDutyOnEveryTimer) {
    struct {
        int pin;
        unsigned ddr, bit, control, connected, compare;
    } const channels[] = {
        {6, kDdrD, 6, 0x44, 0x80, 0x47}, {9, kDdrB, 1, 0x80, 0x80, 0x88}, {3, kDdrD, 3, 0xb0, 0x20, 0xb4}};
    for (const auto& channel : channels) {
        Monitor monitor({{"led", {{"pin", channel.pin}}, "led"}});
        monitor.write_register(channel.ddr, 1u << channel.bit);
        monitor.write_register(channel.compare, 64);
        EXPECT_EQ(monitor->part("led").state(), "off");
        monitor.write_register(channel.control, channel.connected);
        EXPECT_EQ(monitor->part("led").state(), "pwm 64") << channel.pin;
        monitor.write_register(channel.compare, 200);
        EXPECT_EQ(monitor->part("led").state(), "pwm 200") << channel.pin;
        monitor.write_register(channel.control, 0);
        EXPECT_EQ(monitor->part("led").state(), "off") << channel.pin;
    }
}

TEST(Button, Pressed_PullsItsPinDownAndReleasedLetsItGo) {
    Monitor monitor({{"button", {{"pin", 2}}, "button"}});
    monitor.write_register(kPortD, kPd2);
    EXPECT_EQ(monitor.read_register(kPinD) & kPd2, kPd2);
    ASSERT_TRUE(monitor->part("button").command("press", ""));
    monitor->run_for(5ms);
    EXPECT_EQ(monitor->part("button").state(), "pressed");
    EXPECT_EQ(monitor.read_register(kPinD) & kPd2, 0u);
    ASSERT_TRUE(monitor->part("button").command("release", ""));
    monitor->run_for(5ms);
    EXPECT_EQ(monitor.read_register(kPinD) & kPd2, kPd2);
}

TEST(Button, ToVcc_IsHighWhenPressed) {
    Monitor monitor({{"button", {{"pin", 2}, {"to_vcc", true}}, "button"}});
    EXPECT_EQ(monitor.read_register(kPinD) & kPd2, 0u);
    ASSERT_TRUE(monitor->part("button").command("press", ""));
    monitor->run_for(5ms);
    EXPECT_EQ(monitor.read_register(kPinD) & kPd2, kPd2);
}

/// The levels of pin 2, one by one, while a button there is pressed, and while it is released.
std::pair<std::string, std::string> levels_of(const nlohmann::json& button) {
    Monitor monitor(std::vector<PartConfig>{{"button", button, "button"}});
    monitor.write_register(kPortD, kPd2);
    std::string levels;
    monitor->on_pin(2, [&](Level level) { levels += level == Level::kHigh ? '1' : '0'; });
    monitor->part("button").command("press", "");
    monitor->run_for(5ms);
    const auto pressed = std::exchange(levels, {});
    monitor->part("button").command("release", "");
    monitor->run_for(5ms);
    return {pressed, levels};
}

TEST(Button, Contact_BouncesUnlessItIsSteady) {
    EXPECT_EQ(levels_of({{"pin", 2}}), std::pair(std::string("01010"), std::string("10101")));
    EXPECT_EQ(levels_of({{"pin", 2}, {"steady", true}}), std::pair(std::string("0"), std::string("1")));
}

TEST(Button, PressedTwice_ChangesOnce) {
    Monitor monitor({{"button", {{"pin", 2}}, "button"}});
    std::vector<std::string> values;
    record(monitor, values);
    monitor->part("button").command("press", "");
    monitor->part("button").command("press", "");
    monitor->part("button").command("release", "");
    EXPECT_THAT(values, ElementsAre("button pressed", "button released"));
}

TEST(Wire, EitherEndIsAnOutput_DrivesTheOther) {
    Monitor monitor({{"wire", {{"from", 2}, {"to", 3}}, "wire"}});
    monitor.write_register(kDdrD, kPd2);
    monitor.write_register(kPortD, kPd2);
    EXPECT_EQ(monitor.read_register(kPinD) & kPd3, kPd3);
    monitor.write_register(kPortD, 0);
    EXPECT_EQ(monitor.read_register(kPinD) & kPd3, 0u);
    monitor.write_register(kDdrD, kPd3);
    monitor.write_register(kPortD, kPd3);
    EXPECT_EQ(monitor.read_register(kPinD) & kPd2, kPd2);
}

TEST(Wire, Cut_DrivesNothingUntilConnectedAgain) {
    Monitor monitor({{"wire", {{"from", 2}, {"to", 3}}, "wire"}});
    monitor.write_register(kDdrD, kPd2);
    ASSERT_TRUE(monitor->part("wire").command("cut", ""));
    monitor.write_register(kPortD, kPd2);
    EXPECT_EQ(monitor.read_register(kPinD) & kPd3, 0u);
    ASSERT_TRUE(monitor->part("wire").command("connect", ""));
    EXPECT_EQ(monitor.read_register(kPinD) & kPd3, kPd3);
}

TEST(Wire, SharesAPinWithALed) {
    Monitor monitor({{"led", {{"pin", 13}}, "led"}, {"wire", {{"from", 13}, {"to", 2}}, "wire"}});
    monitor.write_register(kDdrB, kPb5);
    monitor.write_register(kPortB, kPb5);
    EXPECT_EQ(monitor->part("led").state(), "on");
    EXPECT_EQ(monitor.read_register(kPinD) & kPd2, kPd2);
}

TEST(Potentiometer, Turned_IsWhatTheChipMeasures) {
    Monitor monitor({{"potentiometer", {{"pin", 14}, {"position", 0.5}}, "pot"}});
    EXPECT_EQ(monitor.ask_word({"A\0", 2}), 511u);
    ASSERT_TRUE(monitor->part("pot").command("set", "0.2"));
    EXPECT_EQ(monitor.ask_word({"A\0", 2}), 204u);
    ASSERT_TRUE(monitor->part("pot").command("set", "1"));
    EXPECT_EQ(monitor.ask_word({"A\0", 2}), 1023u);
    ASSERT_TRUE(monitor->part("pot").command("set", "0"));
    EXPECT_EQ(monitor.ask_word({"A\0", 2}), 0u);
}

TEST(Potentiometer, Reset_KeepsItsPosition) {
    Monitor monitor({{"potentiometer", {{"pin", 15}, {"position", 0.2}}, "pot"}});
    monitor->reset();
    ASSERT_TRUE(monitor->read_line(100ms));
    EXPECT_EQ(monitor.ask_word({"A\1", 2}), 204u);
}

TEST(Potentiometer, BeyondItsEnds_RefusedAndUnchanged) {
    Monitor monitor({{"potentiometer", {{"pin", 14}, {"position", 0.5}}, "pot"}});
    for (const auto* argument : {"1.1", "-0.1", "nan", "", "half", "0.5x"}) {
        const auto done = monitor->part("pot").command("set", argument);
        ASSERT_FALSE(done) << argument;
        EXPECT_THAT(done.error(), HasSubstr("0 to 1"));
    }
    EXPECT_EQ(monitor->part("pot").state(), "0.5");
}

PartConfig values(nlohmann::json inputs, nlohmann::json outputs) {
    return {"values", {{"inputs", std::move(inputs)}, {"outputs", std::move(outputs)}}, "fan"};
}

TEST(Values, Inputs_AreWhatTheChipMeasures) {
    Monitor monitor({values({{{"name", "speed"}, {"pin", "A0"}, {"max", 5000}, {"value", 5000}},
                             {{"name", "raw"}, {"pin", "A1"}},
                             {{"name", "door"}, {"pin", 2}, {"max", 1}}},
                            nlohmann::json::array())});
    EXPECT_EQ(monitor.ask_word({"A\0", 2}), 1023u);
    ASSERT_TRUE(monitor->part("fan").command("set", "speed=2500,raw=77"));
    EXPECT_EQ(monitor.ask_word({"A\0", 2}), 512u);
    EXPECT_EQ(monitor.ask_word({"A\1", 2}), 77u);
    EXPECT_FALSE(monitor->pin(2) == Level::kHigh);
    ASSERT_TRUE(monitor->part("fan").command("set", "door=1"));
    EXPECT_TRUE(monitor->pin(2) == Level::kHigh);
    EXPECT_EQ(monitor->part("fan").state(), "speed=2500,raw=77,door=1");
}

TEST(Values, EachStepOfAnAnalogInput_IsReadAsItWasSet) {
    Monitor monitor({values({{{"name", "raw"}, {"pin", "A0"}}}, nlohmann::json::array())});
    for (const unsigned value : {0u, 1u, 2u, 340u, 341u, 511u, 512u, 1021u, 1022u, 1023u}) {
        ASSERT_TRUE(monitor->part("fan").command("set", "raw=" + std::to_string(value)));
        EXPECT_EQ(monitor.ask_word({"A\0", 2}), value);
    }
}

TEST(Values, Outputs_ShowWhatTheChipDrives) {
    Monitor monitor({values(nlohmann::json::array(), {{{"name", "power"}, {"pin", 13}, {"max", 100}}})});
    EXPECT_EQ(monitor->part("fan").state(), "power=-");
    monitor.write_register(kDdrB, 0x20);
    EXPECT_EQ(monitor->part("fan").state(), "power=0");
    monitor.write_register(kPortB, 0x20);
    EXPECT_EQ(monitor->part("fan").state(), "power=100");
}

TEST(Values, WhatCannotBeSet_RefusedAndUnchanged) {
    Monitor monitor({values(
        {{{"name", "speed"}, {"pin", "A0"}, {"max", 100}}, {{"name", "door"}, {"pin", 2}, {"max", 1}}},
        nlohmann::json::array())});
    for (const auto* argument :
         {"speed=101", "speed=-1", "speed=", "speed", "door=0.5", "none=1", "speed=5,none=1", ","})
        EXPECT_FALSE(monitor->part("fan").command("set", argument)) << argument;
    EXPECT_EQ(monitor->part("fan").state(), "speed=0,door=0");
    EXPECT_THAT(monitor->part("fan").command("set", "none=1").error(), HasSubstr("there is: speed, door"));
}

class EchoTime : public testing::TestWithParam<double> {};

TEST_P(EchoTime, OnePin_LastsAsLongAsSoundNeeds) {
    Monitor monitor({{"ultrasonic", {{"pin", 4}, {"distance", GetParam()}}, "sonar"}});
    EXPECT_NEAR(monitor.ask_word("U") / 2.0, GetParam() * 58.31, 3);
}

TEST_P(EchoTime, TwoPins_LastsAsLongAsSoundNeeds) {
    Monitor monitor({{"ultrasonic", {{"trigger", 4}, {"echo", 5}, {"distance", GetParam()}}, "sonar"}});
    EXPECT_NEAR(monitor.ask_word("u") / 2.0, GetParam() * 58.31, 3);
}

INSTANTIATE_TEST_SUITE_P(Centimetres, EchoTime, testing::Values(2, 10, 100, 400));

TEST(Ultrasonic, SetWhileItRuns_NextEchoIsTheNewOne) {
    Monitor monitor({{"ultrasonic", {{"pin", 4}, {"distance", 10}}, "sonar"}});
    EXPECT_NEAR(monitor.ask_word("U") / 2.0, 583.1, 3);
    ASSERT_TRUE(monitor->part("sonar").command("set", "42"));
    EXPECT_NEAR(monitor.ask_word("U") / 2.0, 42 * 58.31, 3);
    EXPECT_EQ(monitor->part("sonar").state(), "42");
}

TEST(Ultrasonic, NothingInRange_HoldsItsEcho) {
    Monitor monitor({{"ultrasonic", {{"pin", 4}, {"distance", 500}}, "sonar"}});
    EXPECT_NEAR(monitor.ask_word("U") / 2.0, 76000 / 2.0 - 32768, 6)
        << "38 ms are 76000 ticks of a 16-bit timer";
}

TEST(Ultrasonic, Unplugged_DoesNotAnswer) {
    Monitor monitor({{"ultrasonic", {{"pin", 4}, {"distance", 10}}, "sonar"}});
    ASSERT_TRUE(monitor->part("sonar").command("set", "none"));
    EXPECT_EQ(monitor.ask_word("U"), 0u);
}

std::string pulse(unsigned microseconds) {
    return {'S', static_cast<char>(microseconds), static_cast<char>(microseconds >> 8)};
}

TEST(Servo, Pulses_MoveItToTheirAngle) {
    Monitor monitor({{"servo", {{"pin", 9}}, "servo"}});
    std::vector<std::string> values;
    record(monitor, values);
    EXPECT_EQ(monitor->part("servo").state(), "none");
    for (const unsigned microseconds : {544u, 1472u, 1472u, 2400u}) {
        monitor.send(pulse(microseconds));
        monitor->run_for(20ms);
    }
    EXPECT_THAT(values, ElementsAre("servo 0", "servo 90", "servo 180"));
}

TEST(Servo, PulseThatIsNoCommand_DoesNotMoveIt) {
    Monitor monitor({{"servo", {{"pin", 9}}, "servo"}});
    monitor.send(pulse(1472));
    monitor->run_for(20ms);
    for (const unsigned microseconds : {100u, 5000u}) {
        monitor.send(pulse(microseconds));
        monitor->run_for(20ms);
    }
    EXPECT_EQ(monitor->part("servo").state(), "90");
}

TEST(SquareWave, Runs_AtItsFrequencyExactly) {
    Monitor monitor({{"square-wave", {{"pin", 2}, {"hertz", 333}}, "wave"}});
    int rises = 0;
    monitor->on_pin(2, [&](Level level) { rises += level == Level::kHigh ? 1 : 0; });
    monitor->run_for(10s);
    EXPECT_NEAR(rises, 3330, 1);
}

TEST(SquareWave, SetToZero_StaysLow) {
    Monitor monitor({{"square-wave", {{"pin", 2}, {"hertz", 1000}}, "wave"}});
    ASSERT_TRUE(monitor->part("wave").command("set", "0"));
    int changes = 0;
    monitor->on_pin(2, [&](Level) { ++changes; });
    monitor->run_for(100ms);
    EXPECT_EQ(changes, 0);
    EXPECT_EQ(monitor->pin(2), Level::kLow);
}

TEST(SquareWave, Burst_HasSoManyPulsesAndEndsLow) {
    Monitor monitor({{"square-wave", {{"pin", 2}, {"hertz", 1000}}, "wave"}});
    std::vector<std::string> values;
    monitor->on_change([&](const Change& change) { values.push_back(change.value); });
    int rises = 0, falls = 0;
    ASSERT_TRUE(monitor->part("wave").command("set", "0"));
    monitor->on_pin(2, [&](Level level) { ++(level == Level::kHigh ? rises : falls); });
    ASSERT_TRUE(monitor->part("wave").command("burst", "500 25"));
    monitor->run_for(49ms);
    EXPECT_EQ(rises, 25);
    EXPECT_EQ(falls, 24);
    monitor->run_for(100ms);
    EXPECT_EQ(falls, 25);
    EXPECT_EQ(monitor->pin(2), Level::kLow);
    EXPECT_THAT(values, ElementsAre("0", "500", "0"));
}

TEST(SquareWave, SetDuringABurst_RunsForGood) {
    Monitor monitor({{"square-wave", {{"pin", 2}, {"hertz", 0}}, "wave"}});
    ASSERT_TRUE(monitor->part("wave").command("burst", "1000 5"));
    ASSERT_TRUE(monitor->part("wave").command("set", "1000"));
    int changes = 0;
    monitor->on_pin(2, [&](Level) { ++changes; });
    monitor->run_for(100ms);
    EXPECT_NEAR(changes, 200, 1);
}

TEST(SquareWave, BurstThatIsNone_SaysWhatOneIs) {
    Monitor monitor({{"square-wave", {{"pin", 2}, {"hertz", 0}}, "wave"}});
    for (const char* wrong : {"", "50", "50 0", "50 1.5", "0 5", "-1 5", "50 five", "50 5 5", "2000000 1"}) {
        const auto done = monitor->part("wave").command("burst", wrong);
        ASSERT_FALSE(done) << wrong;
        EXPECT_THAT(done.error(), HasSubstr("PULSES")) << wrong;
    }
    EXPECT_EQ(monitor->part("wave").state(), "0");
}

TEST(SquareWave, WatchdogReset_GoesOn) {
    Monitor monitor({{"square-wave", {{"pin", 2}, {"hertz", 1000}}, "wave"}});
    monitor.send("X");
    monitor->run_for(100ms);
    ASSERT_EQ(monitor->last_reset(), ResetCause::kWatchdog);
    int changes = 0;
    monitor->on_pin(2, [&](Level) { ++changes; });
    monitor->run_for(100ms);
    EXPECT_NEAR(changes, 200, 1);
}

TEST(EveryPart, UnknownCommand_SaysWhatItUnderstands) {
    Monitor monitor({{"led", {{"pin", 13}}, "led"},
                     {"button", {{"pin", 2}}, "button"},
                     {"wire", {{"from", 7}, {"to", 8}}, "wire"},
                     {"potentiometer", {{"pin", 14}}, "pot"},
                     {"ultrasonic", {{"pin", 4}}, "sonar"},
                     {"servo", {{"pin", 9}}, "servo"},
                     {"square-wave", {{"pin", 3}}, "wave"}});
    for (const auto& part : monitor->parts()) {
        const auto done = part->command("explode", "");
        ASSERT_FALSE(done) << part->name();
        EXPECT_THAT(done.error(), HasSubstr("explode"));
        EXPECT_THAT(done.error(), HasSubstr(std::string(part->kind().name)));
    }
}

}  // namespace
}  // namespace asip::sim
