// SPDX-License-Identifier: Apache-2.0
// The library on an Arduino core that is not AVR: the whole of it but the servos, which need a timer of an
// AVR.
#include <gtest/gtest.h>

#include <utility>

#include "Asip.h"
#include "AsipBump.h"
#include "AsipDistance.h"
#include "AsipEncoders.h"
#define ASIP_SDA 6
#define ASIP_SCL 7
#include "AsipI2cChips.h"
#include "AsipMotors.h"
#include "AsipReflectance.h"
#include "AsipSerial.h"
#include "AsipTone.h"

namespace asip {
namespace {

Motors motors(2, 3, 4);
Encoders encoders(8, 9);
Bump bump(10);
Reflectance reflectance(11, A0, A1);
Tone buzzer(12);
Distance distance(13);
I2cChips chips;

class GenericCoreTest : public testing::Test {
  protected:
    // There is one board, as on a chip: begun once, then restarted.
    static void SetUpTestSuite() {
        for (Service* service :
             {static_cast<Service*>(&motors), static_cast<Service*>(&encoders), static_cast<Service*>(&bump),
              static_cast<Service*>(&reflectance), static_cast<Service*>(&buzzer),
              static_cast<Service*>(&distance), static_cast<Service*>(&chips)})
            board.add(*service);
        board.begin(F("Generic"));
        banner_ = std::exchange(arduino.from_board, {});
    }
    void SetUp() override {
        for (bool& level : arduino.levels)
            level = false;
        ask("#,R");
    }

    static std::string ask(const std::string& line) {
        arduino.to_board += line + "\n";
        return run(200);
    }
    static std::string run(int passes) {
        for (; passes > 0; --passes)
            board.run();
        return std::exchange(arduino.from_board, {});
    }
    static std::string pass_time(int milliseconds) {
        std::string all;
        for (; milliseconds > 0; --milliseconds) {
            arduino.microseconds += 1000;
            all += run(12);
        }
        return all;
    }

    static std::string banner_;
};

std::string GenericCoreTest::banner_;

TEST_F(GenericCoreTest, Scan_FindsTheChipThatIsThereAndNoOther) {
    for (const int chip : {60, 41, 119}) {
        Wire.chip = chip;
        std::string found = ask("J,s");
        found += pass_time(100);
        EXPECT_NE(found.find("@J,s,1,{" + std::to_string(chip) + "}"), found.npos) << found;
    }
    Wire.chip = 60;
}

TEST_F(GenericCoreTest, Start_OpensTheLineAndNamesTheServices) {
    EXPECT_EQ(banner_, "!Generic running on Arduino with Services: I M E B R T D J \n");
    EXPECT_EQ(arduino.baud, 57600u);
    EXPECT_EQ(ask("#,?"), "@#,?,0,4,Arduino,22,Generic\n");
}

TEST_F(GenericCoreTest, Ports_AreEightPinsEach) {
    EXPECT_EQ(ask("I,M"),
              "@I,M,22,{0:1,0:2,0:4,0:8,0:10,0:20,0:40,0:80,1:1,1:2,1:4,1:8,1:10,1:20,1:40,1:80,2:1,2:2,2:4,"
              "2:8,2:10,2:20}\n");
    EXPECT_EQ(ask("I,c"), "@I,c,22,{1,1,1,1,5,5,5,5,1,1,1,1,1,1,1,1,1,1,3,3,3,3}\n");
    EXPECT_EQ(ask("I,m"), "@I,m,4,{18:0,19:1,20:2,21:3}\n");
}

TEST_F(GenericCoreTest, InputsOutputsAndPwm_Work) {
    arduino.levels[17] = true;
    EXPECT_EQ(run(5), "@I,d,2,2\n");
    EXPECT_EQ(ask("I,P,14,3"), "");
    EXPECT_EQ(ask("I,d,14,1"), "");
    EXPECT_TRUE(arduino.levels[14]);
    EXPECT_EQ(ask("I,a,5,77"), "");
    EXPECT_EQ(arduino.duty[5], 77);
    EXPECT_EQ(ask("I,P,5,3"), "");
    EXPECT_EQ(arduino.duty[5], -1);
    EXPECT_EQ(ask("I,a,14,77"), "~I,a,3{INVALID_PIN}\n");
    EXPECT_EQ(ask("I,d,22,1"), "~I,d,3{INVALID_PIN}\n");
}

TEST_F(GenericCoreTest, AnalogEvents_HaveTheFreeChannels) {
    arduino.analog[2] = 512;
    arduino.analog[3] = 1023;
    ask("I,A,20");
    EXPECT_EQ(pass_time(20), "@I,a,2,{2:512,3:1023}\n");
}

TEST_F(GenericCoreTest, Name_IsNotKeptAndTheAnswerShowsIt) {
    EXPECT_EQ(ask("#,I,desk"), "@#,I,\n");
}

// Wire sends what it was given when the transfer ends.
TEST_F(GenericCoreTest, LastI2cWriteThatNobodyTakes_IsTheFaultOfTheEnd) {
    EXPECT_EQ(ask("J,o,7,61,4000"), "");
    EXPECT_EQ(ask("J,e,7,0,"), "~J,e,12{ADDRESS_NOT_ACKNOWLEDGED 61}\n");
    EXPECT_EQ(ask("J,o,8,60,4000"), "");
    EXPECT_EQ(ask("J,w,8,00"), "");
    EXPECT_EQ(ask("J,e,8,0,"), "@J,e,\n") << "the next one works";
    EXPECT_FALSE(Wire.owned) << Wire.seen;
}

TEST_F(GenericCoreTest, Motors_Run) {
    EXPECT_EQ(ask("M,m,0,-300"), "");
    EXPECT_FALSE(arduino.levels[2]);
    EXPECT_TRUE(arduino.levels[3]);
    EXPECT_EQ(arduino.duty[4], 255);
}

TEST_F(GenericCoreTest, EncoderSteps_AreCountedByInterrupts) {
    for (int cycle = 0; cycle < 10; ++cycle) {
        for (const auto& [pin, high] : {std::pair{8, false}, {9, false}, {8, true}, {9, true}}) {
            arduino.microseconds += 250;
            arduino.drive(static_cast<std::uint8_t>(pin), high);
        }
    }
    ask("E,A,20");
    const auto report = pass_time(20);
    EXPECT_EQ(report.substr(0, 8), "@E,e,1,{");
    EXPECT_NE(report.find(":20}"), std::string::npos) << report;
    EXPECT_EQ(arduino.locks, 0);
}

TEST_F(GenericCoreTest, BumpReflectanceAndTone_Work) {
    arduino.levels[10] = false;
    ask("B,A,20");
    EXPECT_EQ(pass_time(20), "@B,e,1,{0}\n");
    ask("B,A,0");
    arduino.analog[0] = 7;
    arduino.analog[1] = 900;
    ask("R,A,20");
    EXPECT_EQ(pass_time(22), "@R,e,2,{7,900}\n");
    EXPECT_FALSE(arduino.levels[11]);
    ask("R,A,0");
    EXPECT_EQ(ask("T,P,440,500"), "");
    EXPECT_EQ(arduino.tone_hertz, 440u);
}

TEST_F(GenericCoreTest, Distance_IsTimedByInterrupt) {
    ask("D,M");
    arduino.drive(13, true);
    arduino.microseconds += 583;
    arduino.drive(13, false);
    EXPECT_EQ(run(20), "@D,e,1,{10}\n");
}

}  // namespace
}  // namespace asip
