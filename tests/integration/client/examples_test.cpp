// SPDX-License-Identifier: Apache-2.0
// The examples of the documentation, as their users run them.

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/integration/client/simulated_boards.hpp"
#include "tests/support/mosquitto_broker.hpp"

namespace asip::test {
namespace {

TEST(ExampleBlink, OverSerial_BlinksAndEnds) {
    SimulatedBoards boards({"asip_uno"});
    const Finished blink = run({ASIP_TEST_BLINK, boards.serial(), "13", "2"});
    EXPECT_EQ(blink.status, 0) << blink.errors;
    EXPECT_TRUE(wait_until([&] { return boards.led_changes("off") >= 2; })) << boards.output();
    EXPECT_EQ(boards.led_changes("on"), 2);
}

TEST(ExampleTwoBoardSwitch, ButtonOfOneBoard_SwitchesTheLedOfTheOther) {
    SimulatedBoards boards({"asip_uno", "asip_uno_04"});
    ChildProcess program({ASIP_TEST_SWITCH, boards.serial(0), "tcp://127.0.0.1:" + boards.tcp_port(1)});
    ASSERT_TRUE(program.wait_for_output("pin 2 of .* switches pin 13 of")) << program.errors();
    boards.press(0);
    EXPECT_TRUE(boards.wait_for_led("on", 1)) << boards.output();
    boards.release(0);
    EXPECT_TRUE(boards.wait_for_led("off", 1)) << boards.output();
    EXPECT_TRUE(program.running());
}

std::string text_of(const std::string& file) {
    std::ifstream in(std::string(ASIP_TEST_SOURCE) + "/" + file);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

/// A program of another author, with nothing of ours but the topics and the JSON.
TEST(ExampleLamp, PythonWithPlainMqtt_SwitchesTheLedByTheButton) {
    const MosquittoBroker broker;
    SimulatedBoards boards({"asip_uno_services"});
    ChildProcess agent(
        {ASIP_TEST_AGENT, "--serial", boards.serial(), "--name", "uno1", "--broker", broker.address()});
    ChildProcess lamp({"/usr/bin/python3", "-u", ASIP_TEST_SOURCE "/examples/plain_mqtt.py", "uno1",
                       "127.0.0.1", std::to_string(broker.port())});
    ASSERT_TRUE(lamp.wait_for_output("uno1 is online")) << agent.errors() << lamp.errors();
    ASSERT_TRUE(lamp.wait_for_output("distance \\[")) << lamp.output() << lamp.errors();
    boards.press();
    EXPECT_TRUE(boards.wait_for_led("on")) << lamp.output() << lamp.errors();
    boards.release();
    EXPECT_TRUE(boards.wait_for_led("off")) << lamp.output() << lamp.errors();
    EXPECT_EQ(lamp.output().find("failed"), std::string::npos) << lamp.output();
}

TEST(Examples, ShownInTheDocumentation_AreTheOnesThatAreTested) {
    EXPECT_NE(text_of("docs/plain-mqtt.md").find(text_of("examples/plain_mqtt.py")), std::string::npos);
}

}  // namespace
}  // namespace asip::test
