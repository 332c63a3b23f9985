// The examples of the documentation, as their users run them.

#include <gtest/gtest.h>

#include "tests/integration/client/simulated_boards.hpp"

namespace asip::test {
namespace {

TEST(ExampleBlink, OverSerial_BlinksAndEnds) {
    SimulatedBoards boards({"asip_uno"});
    const Finished blink = run({ASIP_TEST_BLINK, boards.serial(), "13", "2"});
    EXPECT_EQ(blink.status, 0) << blink.errors;
    EXPECT_TRUE(wait_until([&] { return boards.led_changes("off") >= 2; })) << boards.output();
    EXPECT_EQ(boards.led_changes("on"), 2);
}

TEST(ExampleBlink, NoSuchPort_EndsWithOneLine) {
    const Finished blink = run({ASIP_TEST_BLINK, "/dev/asip-no-such-port"});
    EXPECT_EQ(blink.status, 1);
    EXPECT_EQ(std::count(blink.errors.begin(), blink.errors.end(), '\n'), 1) << blink.errors;
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

}  // namespace
}  // namespace asip::test
