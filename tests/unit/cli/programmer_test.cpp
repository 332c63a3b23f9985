// SPDX-License-Identifier: Apache-2.0
#include "cli/flash/programmer.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "tests/support/temp_dir.hpp"
#include "tests/support/wait.hpp"

namespace asip::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ProgrammerTest : public ::testing::Test {
  protected:
    test::TempDir folder_;
    std::string hex_ = folder_.write("a.hex", ":00000001FF\n");
};

TEST_F(ProgrammerTest, KnownChips_AreSpokenToAsTheirBootLoaderExpects) {
    EXPECT_THAT(*avrdude_call({.image = hex_, .path = "/dev/ttyACM0", .chip = "ATmega328P"}),
                ElementsAre("avrdude", "-q", "-D", "-p", "m328p", "-c", "arduino", "-P", "/dev/ttyACM0", "-b",
                            "115200", "-U", "flash:w:" + hex_ + ":i", "-x", "attempts=3"));
    EXPECT_THAT(*avrdude_call({.image = folder_.write("a.elf",
                                                      "\x7f"
                                                      "ELF"),
                               .path = "p",
                               .chip = "ATmega2560"}),
                testing::IsSupersetOf(
                    std::vector<std::string>{"m2560", "wiring", "flash:w:" + folder_.file("a.elf") + ":e"}));
    EXPECT_THAT(*avrdude_call({.image = hex_, .path = "p", .chip = "ATmega328P", .baud = 57600}),
                testing::Contains("57600"));
}

TEST_F(ProgrammerTest, UnknownChipOrFile_IsRefusedWithWhatToGive) {
    const Programming leonardo{.image = hex_, .path = "p", .chip = "ATmega32U4"};
    EXPECT_THAT(avrdude_call(leonardo).error(), HasSubstr("--part"));
    auto complete = leonardo;
    complete.part = "m32u4";
    complete.method = "avr109";
    complete.baud = 57600;
    EXPECT_TRUE(avrdude_call(complete));
    EXPECT_THAT(avrdude_call({.image = folder_.write("x", "x"), .path = "p", .chip = "ATmega328P"}).error(),
                HasSubstr("neither"));
    EXPECT_FALSE(avrdude_call({.image = folder_.file("nothing"), .path = "p", .chip = "ATmega328P"}));
}

/// A board says where it is, and any board may say anything.
TEST_F(ProgrammerTest, WhatABoardNamesAsItsPort_IsNotOpenedUnlessItIsOne) {
    std::filesystem::create_symlink("/dev/null", folder_.file("ttyACM0"));
    for (const auto& path : {hex_, folder_.file("nothing"), folder_.file("ttyACM0"), std::string("/dev/null"),
                             std::string("/dev/tty"), std::string("net:10.0.0.1:23"), std::string()})
        EXPECT_THAT(check_port(path).error(), HasSubstr("no serial port")) << path;
    const int board = ::posix_openpt(O_RDWR | O_NOCTTY);
    ASSERT_TRUE(board >= 0 && ::grantpt(board) == 0 && ::unlockpt(board) == 0);
    EXPECT_TRUE(check_port(::ptsname(board)));
    ::close(board);
}

TEST_F(ProgrammerTest, Program_EndsWithItsStatus) {
    for (const auto& [script, status] : {std::pair{"exit 3", 3}, {"kill -9 $$", 137}, {"true", 0}}) {
        auto program = RunningProgram::start({"sh", "-c", script});
        ASSERT_TRUE(program);
        std::optional<int> ended;
        ASSERT_TRUE(test::wait_until([&] { return (ended = program->ended()).has_value(); }));
        EXPECT_EQ(ended, status);
    }
    EXPECT_THAT(RunningProgram::start({"no-such-program"}).error(), HasSubstr("cannot be started"));
}

Expected<PortLock> take(const std::string& port) {
    return PortLock::take(port, [](Duration) {});
}

TEST_F(ProgrammerTest, PortOfAProgramThatLetsGoSoon_IsWaitedFor) {
    const auto port = folder_.write("port", "");
    std::optional<PortLock> other(*take(port));
    int pauses = 0;
    const auto lock = PortLock::take(port, [&](Duration) {
        if (++pauses == 3) other.reset();
    });
    EXPECT_TRUE(lock);
    EXPECT_EQ(pauses, 3);
    Duration waited{};
    EXPECT_THAT(PortLock::take(port, [&](Duration time) { waited += time; }).error(), HasSubstr("in use"));
    EXPECT_EQ(waited, PortLock::kPatience);
}

TEST_F(ProgrammerTest, Lock_IsKeptByWhatWasStartedMeanwhile) {
    const auto port = folder_.write("port", "");
    std::optional<PortLock> lock(*take(port));
    EXPECT_THAT(take(port).error(), HasSubstr("in use"));
    auto program = RunningProgram::start({"sh", "-c", "read line < " + folder_.file("pipe")});
    ASSERT_TRUE(program);
    lock.reset();
    EXPECT_TRUE(test::wait_until([&] { return program->ended().has_value(); })) << "there is no such pipe";
    EXPECT_TRUE(take(port)) << "both have ended";
    lock.emplace(*take(port));
    auto sleeper = RunningProgram::start({"sleep", "1"});
    lock.reset();
    EXPECT_FALSE(take(port)) << "the program has it still";
    EXPECT_TRUE(test::wait_until([&] { return sleeper->ended().has_value(); }));
    EXPECT_TRUE(take(port));
    EXPECT_FALSE(take(folder_.file("nothing")));
}

}  // namespace
}  // namespace asip::cli
