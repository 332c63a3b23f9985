// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <simavr/sim_avr.h>
// sim_avr.h has to come first.
#include <simavr/avr_extint.h>

#include "monitor.hpp"

namespace asip::sim {
namespace {

using namespace std::chrono_literals;

constexpr unsigned kPortD2 = 1 << 2;

// simavr lets a pull-up win over what drives the pin from outside as soon as the firmware writes the port
// again.
TEST(Wiring, PullUpAndOutsideLow_StaysLowWhenThePortIsWritten) {
    Monitor monitor;
    monitor.write_register(kPortD, kPortD2);
    EXPECT_EQ(monitor->pin(2), Level::kHigh);
    monitor->drive(2, Level::kLow);
    EXPECT_EQ(monitor.read_register(kPinD) & kPortD2, 0u);
    monitor.write_register(kPortD, kPortD2 | 1 << 5);
    monitor.write_register(kDdrD, 1 << 5);
    EXPECT_EQ(monitor.read_register(kPinD) & kPortD2, 0u);
    EXPECT_EQ(monitor->pin(2), Level::kLow);
    EXPECT_EQ(monitor->pin(5), Level::kHigh);
}

TEST(Wiring, ReleasedPin_GoesToItsPullUpOrLow) {
    Monitor monitor;
    monitor->drive(2, Level::kHigh);
    EXPECT_EQ(monitor.read_register(kPinD) & kPortD2, kPortD2);
    monitor->release(2);
    EXPECT_EQ(monitor.read_register(kPinD) & kPortD2, 0u);
    monitor.write_register(kPortD, kPortD2);
    monitor->drive(2, Level::kLow);
    monitor->release(2);
    EXPECT_EQ(monitor.read_register(kPinD) & kPortD2, kPortD2);
}

TEST(Wiring, OutputOfTheChip_WinsOverWhatDrivesItFromOutside) {
    Monitor monitor;
    monitor.write_register(kDdrD, kPortD2);
    monitor->drive(2, Level::kHigh);
    EXPECT_EQ(monitor->pin(2), Level::kLow);
    EXPECT_EQ(monitor.read_register(kPinD) & kPortD2, 0u);
    monitor.write_register(kDdrD, 0);
    EXPECT_EQ(monitor->pin(2), Level::kHigh) << "an input again, it sees what still drives it";
    EXPECT_EQ(monitor.read_register(kPinD) & kPortD2, kPortD2);
}

TEST(Wiring, ToggledThroughThePinRegister_IsSeen) {
    Monitor monitor;
    monitor.write_register(kDdrD, kPortD2);
    monitor.write_register(kPinD, kPortD2);
    EXPECT_EQ(monitor->pin(2), Level::kHigh);
    monitor.write_register(kPinD, kPortD2);
    EXPECT_EQ(monitor->pin(2), Level::kLow);
}

TEST(Wiring, OutsideChange_RaisesThePinChangeInterrupt) {
    Monitor monitor;
    monitor.send("I");
    for (int i = 0; i < 5; ++i) {
        monitor->drive(2, Level::kHigh);
        monitor->run_for(100us);
        monitor->drive(2, Level::kLow);
        monitor->run_for(100us);
    }
    EXPECT_EQ(monitor.ask("i", 1), std::string(1, 10));
}

TEST(Wiring, OnPin_CallsAtEachChangeWithItsCycle) {
    Monitor monitor;
    std::vector<Cycles> cycles;
    monitor->on_pin(9, [&](Level) { cycles.push_back(monitor->cycles()); });
    monitor.send({"S\xe8\x03", 3});  // a pulse of 1000 us
    monitor->run_for(2ms);
    ASSERT_EQ(cycles.size(), 2u);
    EXPECT_NEAR(static_cast<double>(cycles[1] - cycles[0]) / 16, 1000, 5);
}

// simavr polls INT0 and INT1 at every cycle while their pin is low, and turns that on again at every reset.
TEST(Wiring, ExternalInterrupts_AreNotPolledWhileThePinIsLowEvenAfterResets) {
    Monitor monitor;
    const auto polled = [&](unsigned char number) {
        return avr_extint_is_strict_lvl_trig(monitor->raw(), number);
    };
    EXPECT_EQ(polled(0), 0);
    EXPECT_EQ(polled(1), 0);
    monitor->reset();
    EXPECT_EQ(polled(0), 0);
    EXPECT_EQ(polled(1), 0);
    ASSERT_TRUE(monitor->read_line(100ms));
    monitor.send("X");
    monitor->run_for(100ms);
    ASSERT_EQ(monitor->last_reset(), ResetCause::kWatchdog);
    EXPECT_EQ(polled(0), 0);
    EXPECT_EQ(polled(1), 0);
}

TEST(Wiring, DrivenPin_StaysDrivenAfterReset) {
    Monitor monitor;
    monitor->drive(2, Level::kHigh);
    monitor->reset();
    ASSERT_TRUE(monitor->read_line(100ms));
    EXPECT_EQ(monitor->pin(2), Level::kHigh);
    EXPECT_EQ(monitor.read_register(kPinD) & kPortD2, kPortD2);
}

// simavr forgets the pin's level at a reset, but not that it has reported it.
TEST(Wiring, PullUpThatWasOnBeforeAReset_WorksAgainAfterIt) {
    Monitor monitor;
    monitor.write_register(kPortD, kPortD2);
    EXPECT_EQ(monitor.read_register(kPinD) & kPortD2, kPortD2);
    monitor->reset();
    ASSERT_TRUE(monitor->read_line(100ms));
    EXPECT_EQ(monitor.read_register(kPinD) & kPortD2, 0u);
    monitor.write_register(kPortD, kPortD2);
    EXPECT_EQ(monitor.read_register(kPinD) & kPortD2, kPortD2);
}

TEST(Wiring, PinThatDoesNotExist_Throws) {
    Monitor monitor;
    EXPECT_THROW(monitor->pin(20), std::out_of_range);
    EXPECT_THROW(monitor->drive(-1, Level::kLow), std::out_of_range);
}

}  // namespace
}  // namespace asip::sim
