#include "sim/pin_claims.hpp"

#include <gtest/gtest.h>

namespace asip::sim {
namespace {

std::string fault(std::vector<PartConfig> parts, const std::string& board = "uno", char uart = 0) {
    BoardConfig config;
    config.board = board;
    config.uart = uart;
    config.parts = std::move(parts);
    const auto checked = check_parts(config, *BoardKind::find(board));
    return checked ? "" : std::to_string(checked.error().index) + ": " + checked.error().reason;
}

TEST(PinClaims, PinThatDoesNotExist_Refused) {
    EXPECT_EQ(fault({{"a", LedSpec{13}}, {"b", LedSpec{20}}}), "1: there is no pin 20 on the uno (0 to 19)");
    EXPECT_EQ(fault({{"a", LedSpec{20}}}, "mega"), "");
    EXPECT_EQ(fault({{"a", LedSpec{-1}}}), "0: there is no pin -1 on the uno (0 to 19)");
}

TEST(PinClaims, PinWithTwoParts_RefusedByTheFirstOnesName) {
    EXPECT_EQ(fault({{"a", ButtonSpec{2}}, {"b", SquareWaveSpec{2}}}), "1: pin 2 is taken by a");
    EXPECT_EQ(fault({{"a", LedSpec{2}}, {"b", ServoSpec{2}}}), "1: pin 2 is taken by a");
    EXPECT_EQ(fault({{"a", UltrasonicSpec{4, 5}}, {"b", ButtonSpec{5}}}), "1: pin 5 is taken by a");
    EXPECT_EQ(fault({{"a", ButtonSpec{2}}, {"b", WireSpec{3, 2}}}), "1: pin 2 is taken by a");
}

TEST(PinClaims, SerialPort_HasItsPins) {
    EXPECT_EQ(fault({{"a", LedSpec{1}}}), "0: pin 1 is taken by the serial port");
    EXPECT_EQ(fault({{"a", LedSpec{18}}}, "mega", '1'), "0: pin 18 is taken by the serial port");
    EXPECT_EQ(fault({{"a", LedSpec{1}}}, "mega", '1'), "");
}

TEST(PinClaims, WireAndListeners_ShareAPin) {
    EXPECT_EQ(fault({{"a", LedSpec{13}}, {"b", WireSpec{13, 2}}, {"c", WireSpec{13, 3}}}), "");
}

TEST(PinClaims, PotentiometerOnDigitalPin_Refused) {
    EXPECT_EQ(fault({{"a", PotentiometerSpec{13}}}), "0: pin 13 of the uno is not an analog input");
    EXPECT_EQ(fault({{"a", PotentiometerSpec{62}}}, "mega"),
              "0: simavr cannot read pin 62: it has only the first 8 analog channels");
}

TEST(PinClaims, SameNameTwice_Refused) {
    EXPECT_EQ(fault({{"a", LedSpec{13}}, {"a", LedSpec{12}}}), "1: another part has this name");
    EXPECT_EQ(fault({{"", LedSpec{13}}}), "0: it has no name");
}

TEST(PinClaims, MoreTimedPartsThanTimers_Refused) {
    std::vector<PartConfig> parts;
    for (int pin = 2; pin < 2 + 33; ++pin)
        parts.push_back({"wave" + std::to_string(pin), SquareWaveSpec{pin}});
    EXPECT_EQ(fault(parts, "mega"), "32: more than 32 ultrasonic sensors and square waves on one board");
    parts.pop_back();
    EXPECT_EQ(fault(parts, "mega"), "");
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
