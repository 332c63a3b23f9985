// SPDX-License-Identifier: Apache-2.0
// Any chip on the I2C bus, by its bytes: what is found, read and written, and how each fault ends.
#include <gtest/gtest.h>

#include <algorithm>

#include "firmware_board.hpp"

namespace asip::firmware {
namespace {

using namespace std::chrono_literals;

const std::vector<sim::PartConfig> kAnyChips = {
    {"mpu6050",
     {{"ax", 12}, {"ay", -340}, {"az", 16384}, {"gx", 1}, {"gy", -32768}, {"gz", 32767}},
     "motion"},
    {"hmc5883l", {{"x", 100}, {"y", -20}, {"z", 30}}, "compass"},
    {"bmp085", {{"pressure", 699.64}, {"temperature", 15.0}}, "barometer"},
    {"sh1106", nlohmann::json::object(), "display"},
    {"button", {{"pin", 18}, {"steady", true}}, "data"},
    {"button", {{"pin", 19}, {"steady", true}}, "clock"}};

class ChipsBoard : public FirmwareBoard {
  public:
    explicit ChipsBoard(std::vector<sim::PartConfig> parts = kAnyChips,
                        const std::string& image = "asip_uno_i2c", const std::string& kind = "uno")
        : FirmwareBoard(image, kind, std::move(parts)) {
        sim().run_for(20ms);
    }

    std::string later(const std::string& request, std::chrono::milliseconds limit = 200ms) {
        const auto at_once = ask(request);
        return at_once.empty() ? next_line(limit) : at_once;
    }
    void tell(const std::string& part, const std::string& verb, const std::string& argument = "") {
        const auto done = sim().part(part).command(verb, argument);
        ASSERT_TRUE(done) << done.error();
    }
};

// The calibration words of the example in the data sheet of the BMP085.
constexpr auto kCalibration = "0198FFB8C7D17FE57FF55A71182E00048000DDF90B34";

TEST(AnyChipTest, Scan_FindsEachChipThatIsThere) {
    ChipsBoard board;
    EXPECT_EQ(board.ask("#,N"), "@#,N,2,{I:ASIP core IO,J:I2C}");
    EXPECT_EQ(board.later("J,s"), "@J,s,4,{30,60,104,119}");
    board.tell("compass", "detach");
    EXPECT_EQ(board.later("J,s"), "@J,s,3,{60,104,119}");
    ChipsBoard empty{std::vector<sim::PartConfig>{}};
    EXPECT_EQ(empty.later("J,s"), "@J,s,0,{}");
}

TEST(AnyChipTest, Transfer_WritesThenReadsWithoutAStopBetween) {
    ChipsBoard board;
    EXPECT_EQ(board.later("J,t,104,1,75"), "@J,t,68") << "who am I";
    EXPECT_EQ(board.later("J,t,104,2,3B"), "@J,t,0000") << "asleep";
    EXPECT_EQ(board.later("J,t,104,0,6B00"), "@J,t,");
    EXPECT_EQ(board.later("J,t,104,14,3B"),
              "@J,t,000CFEAC4000000000018000"
              "7FFF");
    EXPECT_EQ(board.later("J,t,119,16,AA"), "@J,t," + std::string(kCalibration).substr(0, 32));
}

TEST(AnyChipTest, PureReadAndProbe_AddressTheChipAlone) {
    ChipsBoard board;
    EXPECT_EQ(board.later("J,t,119,2,AA"), "@J,t,0198");
    EXPECT_EQ(board.later("J,t,119,2"), "@J,t,FFB8") << "the register steps on";
    EXPECT_EQ(board.later("J,t,119,2,"), "@J,t,C7D1");
    EXPECT_EQ(board.later("J,t,119,0,"), "@J,t,");
    EXPECT_EQ(board.later("J,t,120,0,"), "~J,t,12{ADDRESS_NOT_ACKNOWLEDGED 120}");
    EXPECT_EQ(board.later("J,t,120,2,"), "~J,t,12{ADDRESS_NOT_ACKNOWLEDGED 120}");
    EXPECT_EQ(board.later("J,t,120,2,AA"), "~J,t,12{ADDRESS_NOT_ACKNOWLEDGED 120}");
}

TEST(AnyChipTest, LongRead_IsSeveralRequestsOfOneTransfer) {
    ChipsBoard board;
    EXPECT_EQ(board.ask("J,o,7,119,AA"), "");
    EXPECT_EQ(board.later("J,r,7,16,1"), "@J,r," + std::string(kCalibration).substr(0, 32));
    EXPECT_EQ(board.later("J,r,7,1,1"), "@J,r,80");
    EXPECT_EQ(board.later("J,e,7,5,"), "@J,e,00DDF90B34");
    EXPECT_EQ(board.later("J,t,119,1,AA"), "@J,t,01") << "the bus is free";
}

TEST(AnyChipTest, LongWrite_IsOneTransferOfThePixelsOfALine) {
    ChipsBoard board;
    board.later("J,t,60,0,00AFA1C8B0021 0");
    EXPECT_EQ(board.later("J,t,60,0,00AFA1C8B00210"), "@J,t,");
    // An E of the font that the display reads, then nothing.
    board->send("J,o,1,60,407F494949\nJ,w,1,4100\nJ,w,1,000000\nJ,e,1,0,000000\n");
    EXPECT_EQ(board.next_line(), "@J,e,");
    board->run_for(10ms);
    EXPECT_EQ(board.sim().part("display").state(), "0:E");
}

TEST(AnyChipTest, RepeatedStarts_AreOneTransfer) {
    ChipsBoard board;
    board.ask("J,o,3,104,6B00");
    board.ask("J,o,3,104,75");
    EXPECT_EQ(board.later("J,r,3,1,0"), "@J,r,68");
    board.ask("J,o,3,119,AA");
    EXPECT_EQ(board.later("J,e,3,2,"), "@J,e,0198");
}

TEST(AnyChipTest, FaultInALongTransfer_IsToldAtItsEndAndTheNextWorks) {
    ChipsBoard board;
    EXPECT_EQ(board.ask("J,o,7,61,40"), "");
    EXPECT_EQ(board.ask("J,w,7,00"), "");
    EXPECT_EQ(board.later("J,e,7,0,00"), "~J,e,12{ADDRESS_NOT_ACKNOWLEDGED 61}");
    EXPECT_EQ(board.ask("J,e,7,0,00"), "~J,e,6{WRONG_MODE}");
    EXPECT_EQ(board.ask("J,o,8,60,40"), "");
    board.tell("display", "detach");
    EXPECT_EQ(board.ask("J,w,8,00"), "");
    EXPECT_EQ(board.later("J,e,8,0,00"), "~J,e,13{DATA_NOT_ACKNOWLEDGED 60}");
    board.tell("display", "attach");
    EXPECT_EQ(board.later("J,t,60,0,40"), "@J,t,");
}

TEST(AnyChipTest, TransferOfAnother_WaitsForNoneAndDisturbsNone) {
    ChipsBoard board;
    board.ask("J,o,7,119,AA");
    EXPECT_EQ(board.ask("J,t,104,1,75"), "~J,t,8{DEVICE_NOT_AVAILABLE}");
    EXPECT_EQ(board.ask("J,s"), "~J,s,8{DEVICE_NOT_AVAILABLE}");
    EXPECT_EQ(board.ask("J,o,8,104,75"), "~J,o,8{DEVICE_NOT_AVAILABLE}");
    EXPECT_EQ(board.ask("J,w,8,75"), "~J,w,6{WRONG_MODE}");
    EXPECT_EQ(board.ask("J,e,8,1,"), "~J,e,6{WRONG_MODE}");
    EXPECT_EQ(board.later("J,e,7,2,"), "@J,e,0198");
}

TEST(AnyChipTest, TransferThatNobodyGoesOnWith_IsGivenUpAfterATenthOfASecond) {
    ChipsBoard board;
    board.ask("J,o,7,119,AA");
    board->run_for(80ms);
    EXPECT_EQ(board.later("J,r,7,2,1"), "@J,r,0198") << "each part counts anew";
    board->run_for(80ms);
    EXPECT_EQ(board.later("J,r,7,2,1"), "@J,r,FFB8");
    board->run_for(110ms);
    EXPECT_EQ(board.ask("J,e,7,2,"), "~J,e,6{WRONG_MODE}");
    EXPECT_EQ(board.later("J,t,104,1,75"), "@J,t,68");
    board.ask("J,o,7,119,AA");
    EXPECT_EQ(board.ask("#,R"), "");
    EXPECT_EQ(board.later("J,t,104,1,75"), "@J,t,68") << "a restart frees it";
}

// The chip sends the 0 that its next byte begins with: SDA does not rise for a STOP.
TEST(AnyChipTest, LongReadThatIsGivenUp_LeavesTheBusFree) {
    ChipsBoard board;
    for (int count = 1; count <= 16; ++count) {
        board.ask("J,o,7,119,AA");
        EXPECT_EQ(board.later("J,r,7," + std::to_string(count) + ",1"),
                  "@J,r," + std::string(kCalibration).substr(0, 2 * static_cast<std::size_t>(count)));
        board->run_for(110ms);
        EXPECT_EQ(board.later("J,t,104,1,75"), "@J,t,68") << count;
    }
}

TEST(AnyChipTest, BadRequests_AreErrorsAndTheNextWorks) {
    ChipsBoard board;
    for (const char* request : {"t",
                                "t,104",
                                "t,128,0,",
                                "t,104,17,75",
                                "t,104,1,7",
                                "t,104,1,7G",
                                "t,104,1,75,1",
                                "t,x,1,75",
                                "s,1",
                                "o,7",
                                "o,256,104,",
                                "o,7,104",
                                "w",
                                "w,7,zz",
                                "r,7,0,1",
                                "r,7,17,1",
                                "r,7,1,2",
                                "r,7,1",
                                "e,7",
                                "t,104,0,0123456789012345678901234567890123456789012345678901"}) {
        const auto answer = board.ask(std::string("J,") + request);
        if (std::string(request) == "o,7,104") {
            EXPECT_EQ(answer, "");
            EXPECT_EQ(board.later("J,e,7,0,"), "@J,e,");
            continue;
        }
        EXPECT_EQ(answer, std::string("~J,") + request[0] + ",11{BAD_ARGUMENT}") << request;
    }
    EXPECT_EQ(board.ask("J,x"), "~J,x,2{UNKNOWN_REQUEST}");
    EXPECT_EQ(board.later("J,t,104,1,75"), "@J,t,68");
}

TEST(AnyChipTest, BusThatIsHeldLow_IsAnErrorInTimeAndFreeAfterwards) {
    ChipsBoard board;
    for (const char* line : {"data", "clock"}) {
        board.tell(line, "press");
        const auto before = board->now();
        EXPECT_EQ(board.later("J,t,104,1,75"), "~J,t,14{BUS_HELD_LOW 104}") << line;
        EXPECT_LT(board->now() - before, 40ms);
        EXPECT_EQ(board.later("J,s"), "~J,s,14{BUS_HELD_LOW 8}") << line;
        EXPECT_EQ(board.ask("#,E,here"), "@#,E,here");
        board.tell(line, "release");
        EXPECT_EQ(board.later("J,t,104,1,75"), "@J,t,68") << line;
    }
}

TEST(AnyChipTest, ChipThatHoldsTheClockInTheMiddle_IsAnErrorInTimeAndTheBusFreeAgain) {
    ChipsBoard board;
    for (int i = 0; i < 12; ++i) {
        board->send("J,t,119,16,AA\n");
        board->run_for(2700us + 150us * i);  // the line, the address and some bytes
        board.tell("clock", "press");
        const auto before = board->now();
        EXPECT_EQ(board.next_line(), "~J,t,15{CLOCK_HELD_LOW 119}") << i;
        EXPECT_LT(board->now() - before, 40ms);
        board.tell("clock", "release");
        EXPECT_EQ(board.later("J,t,119,2,AA"), "@J,t,0198") << i;
    }
}

TEST(AnyChipTest, ChipThatIsPulledOutInTheMiddle_EndsInTimeAndTheBusIsFree) {
    ChipsBoard board;
    for (int i = 0; i < 12; ++i) {
        board->send("J,t,119,16,AA\n");
        board->run_for(2700us + 150us * i);
        board.tell("barometer", "detach");
        const auto answer = board.next_line(40ms);  // from there on nobody drives the data line
        EXPECT_TRUE(answer.ends_with("FF") || answer.starts_with("~J,t,1")) << answer;
        EXPECT_EQ(board.later("J,t,119,2,AA"), "~J,t,12{ADDRESS_NOT_ACKNOWLEDGED 119}");
        board.tell("barometer", "attach");
        EXPECT_EQ(board.later("J,t,119,2,AA"), "@J,t,0198") << i;
    }
}

TEST(AnyChipTest, RestartInTheMiddleOfATransfer_BeginsAnew) {
    ChipsBoard board;
    for (int i = 0; i < 20; ++i) {
        board->send("J,o,7,119,AA\nJ,r,7,16,1\n");
        board->run_for(2ms + 200us * i);
        board.ask("#,R");
        board->run_for(50ms);
        board->take_output();
        ASSERT_EQ(board.later("J,t,119,2,AA"), "@J,t,0198") << i;
    }
}

TEST(AnyChipTest, ServicesBesideIt_EachTransferIsWhole) {
    ChipsBoard board(kAnyChips, "asip_uno_i2c_beside");
    board.step_up(500000);
    board->run_for(200ms);
    board.ask("A,A,10");
    board.ask("H,A,7");
    int moved = 0, headed = 0, read = 0, display = 0;
    const auto count = [&](const std::string& line) {
        if (line == "@A,e,3,{12,-340,16384}") return ++moved;
        if (line == "@H,e,4,{100,-20,30,348}") return ++headed;
        if (line == std::string("@J,t,") + std::string(kCalibration).substr(0, 32)) return ++read;
        if (line == std::string("@J,e,") + std::string(kCalibration).substr(32)) return ++read;
        if (line == std::string("@J,r,") + std::string(kCalibration).substr(0, 32)) return display;
        ADD_FAILURE() << line;
        return 0;
    };
    for (int i = 0; i < 100; ++i) {
        board->send("L,W,1,Round " + std::to_string(i) + "\n");
        board->send(i % 2 == 0 ? "J,t,119,16,AA\n" : "J,o,5,119,AA\n");
        if (i % 2 == 1) {
            for (const auto& line : board.lines_within(3ms))
                count(line);
            board->send("J,r,5,16,1\nJ,e,5,6,\n");
        }
        for (const auto& line : board.lines_within(12ms))
            count(line);
    }
    for (const auto& line : board.lines_within(100ms))
        count(line);
    EXPECT_EQ(read, 100);
    EXPECT_GT(moved, 130);
    EXPECT_GT(headed, 180);
    EXPECT_EQ(board.sim().part("display").state(), "1:Round 99");
    EXPECT_EQ(board->line_errors().receive_overruns, 0u);
}

TEST(AnyChipTest, ServiceWithAChipThatIsKeptWaiting_GoesOnWhenTheBusIsFree) {
    ChipsBoard board(kAnyChips, "asip_uno_i2c_beside");
    board.ask("J,o,5,119,AA");
    EXPECT_EQ(board.ask("A,M"), "");
    EXPECT_TRUE(board.lines_within(60ms).empty()) << "the bus is kept";
    EXPECT_EQ(board.next_line(100ms), "@A,e,3,{12,-340,16384}") << "given up";
}

// The interrupt that ends a part comes at every place of the loop.
TEST(AnyChipTest, BusThatIsKept_IsNeverAnothers) {
    ChipsBoard board(kAnyChips, "asip_uno_i2c_beside");
    board.step_up(500000);
    board->run_for(200ms);  // the display is clear
    for (int i = 0; i < 2000; ++i) {
        board->send("J,o,5,119,AA\n");
        board->run_for(280us + 117ns * i);
        board->send("A,M\n");
        const auto early = board.lines_within(2ms);
        ASSERT_TRUE(early.empty()) << i << ": " << early.front();
        board->send("J,e,5,2,\n");
        ASSERT_EQ(board.next_line(), "@J,e,0198") << i;
        ASSERT_EQ(board.next_line(), "@A,e,3,{12,-340,16384}") << i;
    }
}

TEST(AnyChipTest, Mega_ReachesThemOnItsOwnPins) {
    auto parts = kAnyChips;
    parts.resize(4);
    ChipsBoard board(parts, "asip_mega_i2c", "mega");
    EXPECT_EQ(board.later("J,s"), "@J,s,4,{30,60,104,119}");
    EXPECT_EQ(board.later("J,t,119,2,AA"), "@J,t,0198");
}

}  // namespace
}  // namespace asip::firmware
