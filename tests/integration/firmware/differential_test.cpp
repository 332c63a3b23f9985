// SPDX-License-Identifier: Apache-2.0
// What an ASIP 0.4 board and ours answer to the same requests, and what they do. The column of 0.4 is facts,
// measured on its images in the simulator; ours comes from the image. They may differ only where
// docs/protocol.md says so.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <functional>
#include <sstream>

#include "quadrature.hpp"

namespace asip::firmware {
namespace {

using std::chrono::milliseconds;

constexpr std::uint16_t kOcr0a = 0x47, kOcr0b = 0x48, kOcr1a = 0x88;

struct Fact {
    const char* request;
    const char* of_04;           // its answer, and the effect where one is looked at
    const char* ours = nullptr;  // where that is another
    const char* listed = "";     // how the difference is listed in docs/protocol.md
    std::function<std::string(FirmwareBoard&)> effect = nullptr;
};

std::string duty(FirmwareBoard& board, std::uint16_t address) {
    return " duty " + std::to_string(board->peek(address));
}

std::function<std::string(FirmwareBoard&)> duty_at(std::uint16_t address) {
    return [address](FirmwareBoard& board) { return duty(board, address); };
}

std::function<std::string(FirmwareBoard&)> level_of(int pin) {
    return [pin](FirmwareBoard& board) {
        return board->pin(pin) == sim::Level::kHigh ? std::string(" high") : std::string(" low");
    };
}

std::function<std::string(FirmwareBoard&)> angle_of(const char* part) {
    return [part](FirmwareBoard& board) {
        board->run_for(milliseconds(60));
        // A pulse is some microseconds off, whose degree is rounded here.
        const int angle = std::stoi(board->part(part).state());
        return " angle " + std::to_string((angle + 1) / 5 * 5);
    };
}

std::string protocol_page() {
    std::ifstream file(ASIP_SOURCE_DIR "/docs/protocol.md");
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

void expect_facts(FirmwareBoard& board, const std::vector<Fact>& facts) {
    const auto page = protocol_page();
    for (const auto& fact : facts) {
        auto seen = board.ask(fact.request);
        if (fact.effect) seen += fact.effect(board);
        EXPECT_EQ(seen, fact.ours == nullptr ? fact.of_04 : fact.ours) << fact.request;
        if (fact.ours == nullptr) continue;
        EXPECT_STRNE(fact.ours, fact.of_04) << fact.request << " does not differ";
        EXPECT_NE(page.find(fact.listed), std::string::npos) << fact.request << " is not listed";
    }
}

TEST(DifferentialTest, InputAndOutput) {
    FirmwareBoard board("asip_uno");
    expect_facts(board, {
                            {"Z,x", "~Z,?,1{INVALID_SERVICE}"},
                            {"I,P,13,3", ""},
                            {"I,d,13,7", " high", nullptr, "", level_of(13)},
                            {"I,d,13,0", " low", nullptr, "", level_of(13)},
                            {"I,a,6,200", " duty 200", nullptr, "", duty_at(kOcr0a)},
                            {"I,a,9, 64", " duty 64", nullptr, "", duty_at(kOcr1a)},
                            {"I,a,2,64", "~I,a,3{INVALID_PIN}"},
                            {"I,P,25,1", "~I,P,5{INVALID_MODE}", "~I,P,3{INVALID_PIN}",
                             "| `I,P` with a pin or a capability that is not there |"},
                            {"I,P,2,5", "~I,P,5{INVALID_MODE}", "~I,P,4{MODE_UNAVAILABLE}",
                             "| `I,P` with a pin or a capability that is not there |"},
                        });
}

TEST(DifferentialTest, PinsThatAreHighAtStart_AreAFirstEvent) {
    sim::BoardConfig config;
    config.image = std::string(ASIP_IMAGES) + "/asip_uno.elf";
    config.parts.push_back({"button", {{"pin", 4}, {"to_vcc", true}}, "switch"});
    auto board = sim::Board::create(config);
    ASSERT_TRUE(board) << board.error();
    ASSERT_TRUE((*board)->part("switch").command("press", ""));
    ASSERT_TRUE((*board)->read_line(milliseconds(500)));
    EXPECT_EQ((*board)->read_line(milliseconds(500)).value().text, "@I,d,4,10");
}

TEST(DifferentialTest, Servos) {
    FirmwareBoard board("asip_uno_services", "uno", {{"servo", {{"pin", 9}}, "pan"}});
    expect_facts(board, {
                            {"#,N", "@#,N,3,{I:ASIP core IO,D:Distance,S:Servos} angle 90", nullptr, "",
                             angle_of("pan")},
                            {"S,W,0,30", " angle 30", nullptr, "", angle_of("pan")},
                            {"S,W,0,200", " angle 180", nullptr, "", angle_of("pan")},
                        });
}

TEST(DifferentialTest, Robot) {
    FirmwareBoard board("asip_uno_robot", "uno", {{"button", {{"pin", 10}}, "left"}});
    const auto next = [](FirmwareBoard& of) { return of.next_line(); };
    expect_facts(board, {
                            {"M,m,0,100", " duty 100", nullptr, "", duty_at(kOcr0b)},
                            {"M,m,0,12.5", " duty 12", nullptr, "", duty_at(kOcr0b)},
                            {"M,m,0,300", " high", nullptr, "", level_of(5)},
                            {"M,m,9,10", "", "~M,m,7{INVALID_DEVICE_NUMBER}",
                             "| `M,m,id,..` with an `id` that is not there |"},
                            {"B,A,20", "@B,e,2,{1,1}", nullptr, "", next},
                        });
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
    const auto next = [](FirmwareBoard& of) { return of.next_line(); };
    expect_facts(board, {{"D,M", "@D,e,2,{42,0}", "@D,e,2,{42,250}", "| `@D,e` beyond 100 cm |", next}});
}

}  // namespace
}  // namespace asip::firmware
