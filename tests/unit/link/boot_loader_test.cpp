// SPDX-License-Identifier: Apache-2.0
#include "asip/link/boot_loader.hpp"

#include <gmock/gmock.h>

namespace asip::link {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> boards_of(std::string_view board, std::string_view vendor,
                                   std::string_view product) {
    std::vector<std::string> names;
    const auto loaders = boot_loaders(board, vendor, product);
    for (const auto& loader : loaders.value_or(std::vector<BootLoader>{}))
        names.emplace_back(loader.board);
    return names;
}

TEST(BootLoaders, OfAChip_IsTheFirstOfIt) {
    EXPECT_EQ(boot_loader_of_chip("ATmega328P")->baud, "115200");
    EXPECT_EQ(boot_loader_of_chip("ATmega168")->part, "m168");
    EXPECT_FALSE(boot_loader_of_chip("ATmega32U4"));
    EXPECT_FALSE(boot_loader_of_chip(""));
}

TEST(BootLoaders, UsbNumbers_SayWhichBoardItIs) {
    EXPECT_THAT(boards_of("", "2341", "0043"), ElementsAre("uno"));
    EXPECT_THAT(boards_of("", "2a03", "0042"), ElementsAre("mega"));
    EXPECT_THAT(boards_of("", "1a86", "7523"), ElementsAre("nano", "nano-old", "mega"))
        << "a clone is any of them";
    EXPECT_THAT(boards_of("", "0403", "6001"), ElementsAre("nano", "nano-old", "mega"));
    EXPECT_THAT(boards_of("", "", ""), ElementsAre("nano", "nano-old", "mega"));
    EXPECT_THAT(boards_of("nano-old", "2341", "0043"), ElementsAre("nano-old")) << "as it was said";
}

TEST(BootLoaders, BoardThatAvrdudeCannotReach_IsRefusedWithWhatToDo) {
    EXPECT_THAT(boot_loaders("", "2341", "8036").error(), HasSubstr("Arduino IDE")) << "a Leonardo";
    EXPECT_THAT(boot_loaders("", "2e8a", "000a").error(), HasSubstr("Arduino IDE"));
    EXPECT_THAT(boot_loaders("due", "", "").error(), HasSubstr("none of uno, nano"));
}

// What avrdude 7.1 prints, whose output is no terminal.
constexpr std::string_view kWell =
    "avrdude: AVR device initialized and ready to accept instructions\n"
    "Reading | ################################################## | 100% 0.00s\n"
    "avrdude: device signature = 0x1e950f (probably m328p)\n"
    "avrdude: writing 40 bytes flash ...\n"
    "Writing | #########################";

TEST(AvrdudeOutput, StepsAndPercents) {
    AvrdudeOutput output;
    EXPECT_EQ(output.step(), "connecting");
    for (const char c : kWell)
        output.take(std::string_view(&c, 1));
    EXPECT_EQ(output.step(), "writing");
    EXPECT_EQ(output.percent(), 50);
    output.take("######################### | 100% 0.03s\nReading | #####");
    EXPECT_EQ(output.step(), "verifying");
    EXPECT_EQ(output.percent(), 10);
    EXPECT_FALSE(output.may_be_another());
}

std::string failure_of(std::string_view printed, int status = 1) {
    AvrdudeOutput output;
    output.take(printed);
    return output.failure(status, "/dev/ttyUSB0", "avrdude");
}

TEST(AvrdudeOutput, Failures_AreInWordsThatSayWhatToDo) {
    constexpr std::string_view kSilent =
        "avrdude warning: attempt 10 of 10: not in sync: resp=0x3d\n"
        "avrdude stk500_recv() error: programmer is not responding\n";
    EXPECT_THAT(failure_of(kSilent), HasSubstr("no boot loader answers: press the board's reset button"));
    constexpr std::string_view kOther =
        "avrdude: device signature = 0x1e9801 (probably m2560)\n"
        "avrdude error: expected signature for ATmega328P is 1E 95 0F\n"
        "         double check chip or use -F to override this check\n";
    EXPECT_THAT(failure_of(kOther), HasSubstr("another chip"));
    EXPECT_THAT(failure_of("avrdude OS error: cannot open port /dev/ttyUSB0: Device or resource busy\n"),
                HasSubstr("in use by another program"));
    EXPECT_THAT(failure_of("avrdude OS error: cannot open port /dev/ttyUSB0: Permission denied\n"),
                HasSubstr("dialout"));
    EXPECT_THAT(failure_of("", 127), HasSubstr("sudo apt install avrdude"));
    EXPECT_THAT(failure_of("avrdude: something new\n\navrdude done.  Thank you.\n"),
                HasSubstr("something new"));
    EXPECT_THAT(
        failure_of(std::string(kWell) + "\navrdude stk500_recv() error: programmer is not responding\n"),
        HasSubstr("fell silent while it was written"));
}

TEST(AvrdudeOutput, AnotherBootLoader_IsTriedOnlyBeforeAnythingWasWritten) {
    AvrdudeOutput silent;
    silent.take("avrdude warning: attempt 10 of 10: not in sync: resp=0x00\n");
    EXPECT_TRUE(silent.may_be_another());
    AvrdudeOutput half;
    half.take(kWell);
    half.take("\navrdude error: programmer is not responding\n");
    EXPECT_FALSE(half.may_be_another());
    AvrdudeOutput endless;
    endless.take(std::string(100'000, 'x') + "\n");
    EXPECT_FALSE(endless.may_be_another());
}

}  // namespace
}  // namespace asip::link
