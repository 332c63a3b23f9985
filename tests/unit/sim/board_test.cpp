// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "monitor.hpp"
#include "sim/board_kind.hpp"

namespace asip::sim {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

TEST(Board, Created_BootsFromPowerOn) {
    auto board = Board::create(Monitor::config());
    ASSERT_TRUE(board) << board.error();
    EXPECT_EQ((*board)->cycles(), 0u);
    EXPECT_EQ((*board)->board_baud(), 0u);
    const auto line = (*board)->read_line(100ms);
    ASSERT_TRUE(line);
    EXPECT_EQ(line->text, "!\x01") << "MCUSR says power-on";
    EXPECT_EQ((*board)->resets(), 0u);
}

TEST(Board, SameCalls_GiveTheSameResultToTheCycle) {
    const auto run = [] {
        Monitor monitor({{"square-wave", {{"pin", 2}, {"hertz", 777}}, "wave"}});
        monitor.send("I");
        monitor->run_for(50ms);
        monitor->send("iE!T\x05");
        monitor->run_for(50ms);
        std::vector<std::pair<char, Cycles>> bytes;
        for (const auto& received : monitor->take_bytes())
            bytes.emplace_back(received.byte, received.cycle);
        return bytes;
    };
    const auto first = run();
    EXPECT_EQ(first.size(), 7u);
    EXPECT_EQ(run(), first);
}

TEST(Board, RunFor_PassesExactlyThatMuchTime) {
    Monitor monitor;
    const auto before = monitor->cycles();
    monitor->run_for(10ms);
    EXPECT_GE(monitor->cycles() - before, 160000u);
    EXPECT_LE(monitor->cycles() - before, 160100u);
    EXPECT_EQ(monitor->to_time(16'000'000), 1s);
}

TEST(Board, RunForLessThanACycle_StillPasses) {
    Monitor monitor;
    const auto end = monitor->now() + 1us;
    for (int runs = 0; runs < 100 && monitor->now() < end; ++runs)
        monitor->run_for(1ns);
    EXPECT_GE(monitor->now(), end);
}

TEST(Board, EepromWrite_TakesItsTimeOnTheChip) {
    constexpr unsigned kEecr = 0x3f, kEepe = 1 << 1;
    Monitor monitor;
    const std::string write{'e', '\x05', '\x00', 'x'};
    monitor.send(write);
    EXPECT_EQ(monitor->peek(kEecr) & kEepe, kEepe);
    EXPECT_EQ(monitor.read_register(kEecr) & kEepe, kEepe) << "a look at the register does not end it";
    const bool done = monitor->run_until([&] { return (monitor->peek(kEecr) & kEepe) == 0; }, 10ms);
    EXPECT_TRUE(done);
    EXPECT_EQ(monitor->eeprom()[5], 'x');
    const auto began = monitor->now();
    monitor.send(write);
    monitor->run_until([&] { return (monitor->peek(kEecr) & kEepe) != 0; }, 10ms);
    const auto busy = monitor->now();
    monitor->run_until([&] { return (monitor->peek(kEecr) & kEepe) == 0; }, 10ms);
    EXPECT_GE(monitor->now() - busy, 3300us);
    EXPECT_LE(monitor->now() - began, 6ms);
}

TEST(Board, RunUntilNeverTrue_StopsAtItsLimit) {
    Monitor monitor;
    const auto before = monitor->now();
    EXPECT_FALSE(monitor->run_until([] { return false; }, 5ms));
    EXPECT_GE(monitor->now() - before, 5ms);
    EXPECT_LE(monitor->now() - before, 6ms);
}

TEST(Board, ReadLineWithNoneComing_GivesNothingAfterItsLimit) {
    Monitor monitor;
    monitor.send("Ea");
    EXPECT_FALSE(monitor->read_line(20ms));
    EXPECT_EQ(monitor->take_output(), "a") << "what came without a line end is still there";
}

TEST(Board, ReadLine_GivesLinesOneByOneWithoutTheirEnds) {
    Monitor monitor;
    monitor->send(
        "EaE\r"
        "E\n"
        "EbE\n");
    const auto first = monitor->read_line(20ms);
    const auto second = monitor->read_line(20ms);
    ASSERT_TRUE(first && second);
    EXPECT_EQ(first->text, "a");
    EXPECT_EQ(second->text, "b");
    EXPECT_LT(first->cycle, second->cycle);
}

TEST(Board, OnByte_GetsTheBytesInsteadOfTheBuffer) {
    Monitor monitor;
    std::string bytes;
    monitor->on_byte([&](char byte) { bytes.push_back(byte); });
    monitor.send("Ea");
    monitor->run_for(1ms);
    EXPECT_EQ(bytes, "a");
    EXPECT_EQ(monitor->take_output(), "");
}

TEST(Board, Reset_IsSeenAsExternalAndReported) {
    Monitor monitor;
    std::vector<ResetCause> causes;
    monitor->on_reset([&](ResetCause cause) { causes.push_back(cause); });
    monitor->reset();
    EXPECT_EQ(monitor->read_line(100ms)->text, "!\x02");
    monitor.send("X");
    EXPECT_EQ(monitor->read_line(100ms)->text, "!\x08");
    monitor->power_cycle();
    EXPECT_EQ(monitor->read_line(100ms)->text, "!\x01");
    EXPECT_THAT(causes,
                testing::ElementsAre(ResetCause::kExternal, ResetCause::kWatchdog, ResetCause::kPowerOn));
    EXPECT_EQ(monitor->resets(), 3u);
}

TEST(Board, FirmwareStopsTheChip_TimePassesAndResetRevives) {
    Monitor monitor;
    monitor.send("Z");
    monitor->run_for(1ms);
    EXPECT_FALSE(monitor->alive());
    const auto before = monitor->now();
    monitor->run_for(1s);
    EXPECT_GE(monitor->now() - before, 1s);
    monitor->reset();
    EXPECT_TRUE(monitor->alive());
    EXPECT_TRUE(monitor->read_line(100ms));
}

TEST(Board, WatchedStack_ReportsTheDeepestUse) {
    Monitor monitor;
    monitor->watch_stack();
    monitor.ask("K\x01", 1);
    const auto shallow = monitor->max_stack();
    EXPECT_GT(shallow, 20u);
    EXPECT_LT(shallow, 80u);
    monitor.ask("K\x0b", 1);
    const auto per_level = (monitor->max_stack() - shallow) / 10;
    EXPECT_GE(per_level, 12u) << "ten bytes of frame and the return address";
    EXPECT_LE(per_level, 20u);
    EXPECT_LT(monitor->stack_now(), shallow);
}

TEST(Board, Memory_IsReadWrittenAndNamed) {
    Monitor monitor;
    const auto edges = monitor->symbol("edges");
    ASSERT_TRUE(edges);
    EXPECT_GE(*edges, 0x100u);
    monitor->poke(static_cast<std::uint16_t>(*edges), 42);
    EXPECT_EQ(monitor->peek(static_cast<std::uint16_t>(*edges)), 42);
    EXPECT_EQ(monitor.ask("i", 1), "\x2a");
    EXPECT_FALSE(monitor->symbol("no_such_thing"));
    EXPECT_EQ(monitor->peek(0xffff), 0);
}

TEST(Board, EepromFile_KeepsItFromRunToRun) {
    TemporaryFolder folder;
    auto config = Monitor::config();
    config.eeprom = folder / "uno.eeprom";
    {
        Monitor monitor(config);
        EXPECT_EQ(monitor->eeprom(), std::vector<std::uint8_t>(1024, 0xff));
        monitor->set_eeprom(1020, {1, 2, 3, 4, 5});
    }
    Monitor again(config);
    const auto bytes = again->eeprom();
    EXPECT_EQ(std::vector<std::uint8_t>(bytes.begin() + 1019, bytes.end()),
              (std::vector<std::uint8_t>{0xff, 1, 2, 3, 4}));
    EXPECT_FALSE(std::filesystem::exists(folder / "uno.eeprom.new"));
}

TEST(Board, EepromFileThatCannotBeWritten_IsReported) {
    TemporaryFolder folder;
    auto config = Monitor::config();
    config.eeprom = folder / "missing" / "uno.eeprom";
    Monitor monitor(config);
    monitor->set_eeprom(0, {1});
    EXPECT_FALSE(monitor->save_eeprom());
}

std::string refusal(const BoardConfig& config) {
    const auto board = Board::create(config);
    return board ? "none" : board.error();
}

TEST(Board, EepromFileIsAFolder_Refused) {
    TemporaryFolder folder;
    auto config = Monitor::config();
    config.eeprom = folder / "";
    EXPECT_THAT(refusal(config), HasSubstr("cannot read the EEPROM file: is a folder"));
}

TEST(Board, MissingImage_RefusedByName) {
    auto config = Monitor::config();
    config.image = "/nowhere/sketch.elf";
    EXPECT_THAT(refusal(config), HasSubstr("/nowhere/sketch.elf: cannot read"));
}

TEST(Board, ImageOfThisComputer_RefusedAsNotAvr) {
    auto config = Monitor::config();
    config.image = "/proc/self/exe";
    EXPECT_THAT(refusal(config), HasSubstr("not for AVR"));
}

TEST(Board, ImageWithoutEnd_Refused) {
    auto config = Monitor::config();
    config.image = "/dev/zero";
    EXPECT_THAT(refusal(config), HasSubstr("too large for a firmware image"));
}

TEST(Board, ImageTooLargeForTheChip_Refused) {
    TemporaryFolder folder;
    write_file(folder / "large.hex", ":020000040001F9\n:0100000000FF\n:00000001FF\n");
    auto config = Monitor::config();
    config.image = folder / "large.hex";
    EXPECT_THAT(refusal(config), HasSubstr("65537 bytes, the atmega328p of the uno only 32768"));
}

std::string hex_of(const std::vector<unsigned>& bytes) {
    std::string text;
    for (std::size_t at = 0; at < bytes.size(); at += 4) {
        unsigned sum = 4 + static_cast<unsigned>(at >> 8) + static_cast<unsigned>(at & 0xff);
        text += fmt::format(":04{:04X}00", at);
        for (std::size_t i = at; i < at + 4; ++i) {
            text += fmt::format("{:02X}", bytes[i]);
            sum += bytes[i];
        }
        text += fmt::format("{:02X} \t\r\n", -sum & 0xff);
    }
    return text + ":00000001FF\r\n";
}

TEST(Board, ImageOfAnotherChip_RefusedByItsVectors) {
    TemporaryFolder folder;
    for (const unsigned vectors : {26u, 31u, 35u, 43u, 57u}) {
        std::vector<unsigned> bytes;
        for (unsigned i = 0; i < vectors; ++i)
            bytes.insert(bytes.end(), {0x0c, 0x94, 0, 0});
        bytes.insert(bytes.end(), {0, 0, 0, 0});
        write_file(folder / "other image.hex", hex_of(bytes));
        for (const auto& kind : BoardKind::all()) {
            auto config = Monitor::config();
            config.board = kind.name;
            config.image = folder / "other image.hex";
            const bool own = vectors == (kind.chip == "atmega328p"    ? 26u
                                         : kind.chip == "atmega1284p" ? 35u
                                         : kind.chip == "atmega32u4"  ? 43u
                                                                      : 57u);
            const auto board = Board::create(config);
            EXPECT_EQ(board.has_value(), own) << kind.name << vectors;
            EXPECT_THAT(own ? "" : board.error(),
                        HasSubstr(own ? "" : "other image.hex: an image for another chip"));
        }
    }
}

// A chip with less memory than the image thinks: what its stack overwrites must not be ours.
TEST(Board, StackBeyondTheMemory_HarmsNothing) {
    TemporaryFolder folder;
    // Stack pointer 0xffff; then a call of itself, for ever.
    write_file(folder / "stack.hex",
               hex_of({0x0f, 0xef, 0x0d, 0xbf, 0x0f, 0xef, 0x0e, 0xbf, 0xff, 0xdf, 0, 0}));
    auto config = Monitor::config();
    config.image = folder / "stack.hex";
    for (int i = 0; i < 20; ++i) {
        auto board = Board::create(config);
        ASSERT_TRUE(board) << board.error();
        (*board)->run_for(std::chrono::milliseconds(4));
    }
}

// The same of a pointer into flash: ELPM at 0xffffff, for ever.
TEST(Board, FlashReadBeyondItsEnd_HarmsNothing) {
    TemporaryFolder folder;
    write_file(folder / "far.hex", hex_of({0x0f, 0xef, 0x00, 0x2e, 0x0b, 0xbf, 0xef, 0xef, 0xff, 0xef, 0xd8,
                                           0x95, 0xf9, 0xcf, 0, 0}));
    for (const char* kind : {"uno", "mega", "leonardo"}) {
        auto config = Monitor::config();
        config.board = kind;
        config.image = folder / "far.hex";
        auto board = Board::create(config);
        ASSERT_TRUE(board) << board.error();
        (*board)->run_for(std::chrono::milliseconds(4));
    }
}

TEST(Board, UnknownBoardOrUart_Refused) {
    auto config = Monitor::config();
    config.board = "due";
    EXPECT_THAT(refusal(config), HasSubstr("\"due\": uno, mega, leonardo"));
    config = Monitor::config();
    config.uart = '1';
    EXPECT_THAT(refusal(config), HasSubstr("the uno has no USART 1"));
}

}  // namespace
}  // namespace asip::sim
