// SPDX-License-Identifier: Apache-2.0
// What an ASIP 0.4 board and ours answer to the same requests, and what they do. The column of 0.4 is facts,
// measured on its images in the simulator; ours comes from the image. They may differ only where
// docs/protocol.md says so.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "quadrature.hpp"

namespace asip::firmware {
namespace {

using std::chrono::milliseconds;

/// What is looked at behind an answer: "level 13", "duty 6", "angle pan", "next".
std::string look(FirmwareBoard& board, const std::string& at) {
    const auto what = at.substr(0, at.find(' '));
    const auto where = at.substr(at.find(' ') + 1);
    if (what == "next") return board.next_line();
    if (what == "level") return board->pin(std::stoi(where)) == sim::Level::kHigh ? " high" : " low";
    if (what == "duty") {
        static const std::map<std::string, std::uint16_t> kRegisters = {
            {"5", 0x48}, {"6", 0x47}, {"9", 0x88}};
        return " duty " + std::to_string(board->peek(kRegisters.at(where)));
    }
    if (what != "angle") throw std::runtime_error("differential.json: cannot look at " + at);
    board->run_for(milliseconds(60));
    // A pulse is some microseconds off, whose degree is rounded here.
    return " angle " + std::to_string((std::stoi(board->part(where).state()) + 1) / 5 * 5);
}

std::string protocol_page() {
    std::ifstream file(ASIP_SOURCE_DIR "/docs/protocol.md");
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

/// The facts of one script of tests/literal/differential.json.
void expect_facts(FirmwareBoard& board, const std::string& script) {
    const auto page = protocol_page();
    std::ifstream file(ASIP_SOURCE_DIR "/tests/literal/differential.json");
    const auto facts = nlohmann::json::parse(file);
    for (const auto& fact : facts.at("scripts").at(script)) {
        const std::string request = fact.at("request"), of_04 = fact.at("of_04");
        auto seen = board.ask(request);
        if (fact.contains("look")) seen += look(board, fact.at("look"));
        EXPECT_EQ(seen, fact.value("ours", of_04)) << request;
        if (!fact.contains("ours")) continue;
        EXPECT_NE(fact.at("ours"), of_04) << request << " does not differ";
        EXPECT_NE(page.find(fact.at("listed").get<std::string>()), std::string::npos)
            << request << " is not listed";
    }
}

TEST(DifferentialTest, InputAndOutput) {
    FirmwareBoard board("asip_uno");
    expect_facts(board, "input and output");
}

TEST(DifferentialTest, PinsThatAreHighAtStart_AreAFirstEvent) {
    sim::BoardConfig config;
    config.image = std::string(ASIP_IMAGES) + "/asip_uno.elf";
    config.parts.push_back({"button", {{"pin", 4}, {"to_vcc", true}, {"steady", true}}, "switch"});
    auto board = sim::Board::create(config);
    ASSERT_TRUE(board) << board.error();
    ASSERT_TRUE((*board)->part("switch").command("press", ""));
    ASSERT_TRUE((*board)->read_line(milliseconds(500)));
    EXPECT_EQ((*board)->read_line(milliseconds(500)).value().text, "@I,d,4,10");
}

TEST(DifferentialTest, Servos) {
    FirmwareBoard board("asip_uno_services", "uno", {{"servo", {{"pin", 9}}, "pan"}});
    expect_facts(board, "servos");
}

TEST(DifferentialTest, Robot) {
    FirmwareBoard board("asip_uno_robot", "uno", {{"button", {{"pin", 10}, {"steady", true}}, "left"}});
    expect_facts(board, "robot");
    EXPECT_NE(board.ask("#,N").find("B:Bump Sensors,R:IR Sensors"), std::string::npos);
}

// Measured on 0.4 with both wheels forwards: +13, +13, and 15,560 us from edge to edge.
TEST(DifferentialTest, WheelsInMotion) {
    FirmwareBoard board("asip_uno_mirto");
    Quadrature wheels(board, {{3, 7}, {2, 4, true}});
    board.ask("E,A,210");
    wheels.turn(7, std::chrono::microseconds(31'120));
    long pulse[2] = {0, 0}, count[2] = {0, 0};
    const auto line = board.next_line();
    ASSERT_EQ(
        std::sscanf(line.c_str(), "@E,e,2,{%ld:%ld,%ld:%ld}", &pulse[0], &count[0], &pulse[1], &count[1]), 4)
        << line;
    EXPECT_NEAR(static_cast<double>(pulse[0]), 15'560, 12);
    EXPECT_NEAR(static_cast<double>(pulse[1]), 15'560, 12);
    EXPECT_NEAR(static_cast<double>(count[0]), 13, 1);
    EXPECT_EQ(count[1], count[0]);
}

TEST(DifferentialTest, DistanceBeyondAMetre_IsMeasured) {
    FirmwareBoard board("asip_uno_services", "uno",
                        {{"ultrasonic", {{"pin", 7}, {"distance", 42}}, "near"},
                         {"ultrasonic", {{"pin", 8}, {"distance", 250}}, "far"}});
    expect_facts(board, "distance");
}

}  // namespace
}  // namespace asip::firmware
