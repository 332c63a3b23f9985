// SPDX-License-Identifier: Apache-2.0
// Any chip on the SPI pins: what goes over them, and what a chip answers.
#include <gtest/gtest.h>

#include "firmware_board.hpp"

namespace asip::firmware {
namespace {

using namespace std::chrono_literals;

class SpiBoard : public FirmwareBoard {
  public:
    explicit SpiBoard(const std::string& kind = "uno")
        : FirmwareBoard("asip_" + kind + "_spi", kind,
                        {{"mcp3008", {{"select", 10}, {"v0", 2.5}, {"v7", 5}}, "volts"},
                         {"mcp3008", {{"select", 9}, {"v0", 1.25}}, "others"}}) {}

    std::string transfer(const std::string& arguments) {
        const auto at_once = ask("V,t," + arguments);
        return at_once.empty() ? next_line(100ms) : at_once;
    }
};

TEST(SpiTest, Service_IsNamedAndOwnsItsPins) {
    SpiBoard board;
    EXPECT_EQ(board.ask("#,N"), "@#,N,2,{I:ASIP core IO,V:SPI}");
    EXPECT_EQ(board.ask("#,S"), "@#,S,20,{@,@,I,I,I,I,I,I,I,V,V,V,V,V,I,I,I,I,I,I}");
    EXPECT_EQ(board->pin(9), sim::Level::kHigh) << "no chip is chosen";
    EXPECT_EQ(board->pin(10), sim::Level::kHigh);
}

TEST(SpiTest, Chips_AnswerAtEachRateAndOnUnoAndMega) {
    for (const std::string kind : {"uno", "mega"}) {
        SpiBoard board(kind);
        for (const char* kilohertz : {"8000", "4000", "1000", "600", "300", "130", "1"}) {
            EXPECT_EQ(board.transfer("10," + std::string(kilohertz) + ",0,0,018000"), "@V,t,000200")
                << kilohertz;
            EXPECT_EQ(board.transfer("9," + std::string(kilohertz) + ",0,0,018000"), "@V,t,000100")
                << kilohertz;
        }
        EXPECT_EQ(board.transfer("10,1000,0,0,01F000"), "@V,t,0003FF") << "5 V at the last input";
        EXPECT_EQ(board.transfer("255,1000,0,0,018000").substr(0, 5), "@V,t,") << "none is chosen";
        EXPECT_EQ(board.transfer("10,1000,0,0,"), "@V,t,");
    }
}

TEST(SpiTest, ChipThatIsKept_GoesOnWhereItWas) {
    SpiBoard board;
    EXPECT_EQ(board.transfer("10,1000,0,1,01"), "@V,t,00");
    EXPECT_EQ(board->pin(10), sim::Level::kLow);
    EXPECT_EQ(board.transfer("9,1000,0,0,01"), "~V,t,8{DEVICE_NOT_AVAILABLE}");
    EXPECT_EQ(board.transfer("10,1000,0,0,8000"), "@V,t,0200");
    EXPECT_EQ(board->pin(10), sim::Level::kHigh);
    EXPECT_EQ(board.transfer("10,1000,0,1,01"), "@V,t,00");
    board->run_for(300ms);
    EXPECT_EQ(board->pin(10), sim::Level::kHigh) << "it is given up";
    EXPECT_EQ(board.transfer("9,1000,0,0,018000"), "@V,t,000100");
}

TEST(SpiTest, BadRequests_AreReportedAndChooseNothing) {
    SpiBoard board;
    for (const char* request :
         {"10,1000,0,0,0", "10,0,0,0,01", "10,1000,4,0,01", "10,1000,0,2,01", "10,1000,0,0,xx", "10,1000"})
        EXPECT_EQ(board.transfer(request), "~V,t,11{BAD_ARGUMENT}") << request;
    EXPECT_EQ(board.transfer("10,1000,0,0," + std::string(34, '0')), "~V,t,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.transfer("8,1000,0,0,01"), "~V,t,3{INVALID_PIN}");
    EXPECT_EQ(board.ask("V,x"), "~V,x,2{UNKNOWN_REQUEST}");
    EXPECT_EQ(board->pin(10), sim::Level::kHigh);
    EXPECT_EQ(board.transfer("10,1000,0,0,018000"), "@V,t,000200");
}

}  // namespace
}  // namespace asip::firmware
