// SPDX-License-Identifier: Apache-2.0
#include "cli/text/table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "cli/text/terminal_buffer.hpp"
#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

/// What the terminal gets.
std::string sent(const std::string& text) {
    std::ostringstream terminal;
    TerminalBuffer buffer(terminal.rdbuf());
    std::ostream(&buffer) << text << std::flush;
    return terminal.str();
}

Table boards() {
    Table table({{"BOARD"}, {"PINS", true}, {"SERVICES", false, 8}});
    table.add({"uno1", "20", "io distance servo"});
    table.add({"kitchen", "6", "io"});
    return table;
}

TEST(Table, NoLimit_AlignsColumnsWithoutTrailingBlanks) {
    EXPECT_EQ(boards().render(0, false),
              "BOARD    PINS  SERVICES\n"
              "uno1       20  io distance servo\n"
              "kitchen     6  io\n");
}

TEST(Table, NarrowTerminal_CutsOnlyWhatMayBeCut) {
    const auto text = boards().render(24, false);
    EXPECT_EQ(text,
              "BOARD    PINS  SERVICES\n"
              "uno1       20  io dista…\n"
              "kitchen     6  io\n");
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        EXPECT_LE(display_width(line), 24U) << line;
}

TEST(Table, TerminalNarrowerThanColumnsAllow_KeepsTheirLeast) {
    EXPECT_THAT(boards().render(5, false), testing::HasSubstr("kitchen     6  io"));
    EXPECT_THAT(boards().render(5, false), testing::HasSubstr("io dist…"));
}

TEST(Table, WideCharacters_StayInColumns) {
    Table table({{"NAME"}, {"N"}});
    table.add({"温度", "1"});
    table.add({"Küche", "2"});
    EXPECT_EQ(table.render(0, false), "NAME   N\n温度   1\nKüche  2\n");
}

TEST(Table, Colours_AppearOnlyWhenAskedFor) {
    Table table({{"STATE"}});
    table.add({Cell("online", Colour::kGreen)});
    EXPECT_EQ(table.render(0, false), "STATE\nonline\n");
    EXPECT_EQ(sent(table.render(0, true)), "\033[1mSTATE\033[0m\n\033[32monline\033[0m\n");
}

TEST(TerminalBuffer, TextOfAStranger_LosesItsControlCharacters_WhereverItIsCut) {
    const std::string text = "kü\x1b[31mche\u009b2J\x7f\u202e\r\xff\n\t温";
    const std::string harmless = "kü?[31mche?2J????\n\t温";
    EXPECT_EQ(sent(text), harmless);
    for (std::size_t cut = 0; cut < text.size(); ++cut) {
        std::ostringstream terminal;
        {
            TerminalBuffer buffer(terminal.rdbuf());
            std::ostream(&buffer) << text.substr(0, cut) << text.substr(cut);
        }
        EXPECT_EQ(terminal.str(), harmless) << cut;
    }
}

TEST(TerminalBuffer, OwnControls_ArriveByteByByte_AndTornCharactersAreShownAtTheEnd) {
    std::ostringstream terminal;
    TerminalBuffer buffer(terminal.rdbuf());
    std::ostream out(&buffer);
    for (const char c : own_control('\033') + "[31mred" + own_control('\r') + "\xe6\xb8")
        out.put(c);
    EXPECT_EQ(terminal.str(), "\033[31mred\r");
    out.flush();
    EXPECT_EQ(terminal.str(), "\033[31mred\r??");
}

TEST(Table, CellFromAStranger_CannotMoveTheCursor) {
    Table table({{"SKETCH"}});
    table.add({"x\x1b[2J\ny"});
    EXPECT_EQ(sent(table.render(0, true)), "\033[1mSKETCH\033[0m\nx?[2J?y\n");
}

TEST(Table, RowsAddedLater_StandInTheColumnsOfBefore) {
    auto table = boards();
    table.render(0, false);
    table.add({"nano", "8", "io"});
    EXPECT_EQ(table.render_more(0, false), "nano        8  io\n");
    table.add({"mega", "70", ""});
    EXPECT_EQ(table.render_more(0, false), "mega       70\n");
}

TEST(Table, CellsLikeThoseAbove_KeepTheirColours) {
    Table table({{"STATE"}, {"N", true}});
    table.add_cell("online", Colour::kGreen);
    table.add_cell("1");
    table.add_cell("online", Colour::kRed);
    table.add_cell("1");
    EXPECT_EQ(sent(table.render(0, true)),
              "\033[1mSTATE\033[0m   \033[1mN\033[0m\n"
              "\033[32monline\033[0m  1\n"
              "\033[31monline\033[0m  1\n");
}

TEST(Table, RowsThatDifferInTheirFirstCellOnly_AreWhole) {
    Table table({{"BOARD"}, {"STATE"}, {"N", true}, {"NOTE"}});
    for (const char* name : {"uno", "a-longer-name", "", "x"})
        table.add({name, Cell("online", Colour::kGreen), "7", ""});
    table.add({"uno", "lost", "7", "!"});
    table.add({"", "lost", "7", "!"});
    table.add({"y", "", "", ""});
    table.add({"zz", "", "", ""});
    table.add({"", "", "", ""});
    EXPECT_EQ(table.render(0, false),
              "BOARD          STATE   N  NOTE\n"
              "uno            online  7\n"
              "a-longer-name  online  7\n"
              "               online  7\n"
              "x              online  7\n"
              "uno            lost    7  !\n"
              "               lost    7  !\n"
              "y\n"
              "zz\n"
              "\n");
    EXPECT_THAT(sent(table.render(0, true)), testing::HasSubstr("x              \033[32monline\033[0m  7\n"));
}

TEST(Table, HugeCell_DoesNotWidenTheOtherRows) {
    Table table({{"BOARD"}, {"SERVICES", false, 8}, {"N"}});
    const std::string huge(1 << 20, 'x');
    table.add({"a", huge, "1"});
    for (int i = 0; i < 1000; ++i)
        table.add({"b", "io", "2"});
    const auto whole = table.render(0, false);
    EXPECT_THAT(whole,
                testing::StartsWith("BOARD  SERVICES  N\na      " + huge + "  1\nb      io        2\n"));
    EXPECT_LT(whole.size(), huge.size() + 100'000);
    EXPECT_THAT(table.render(30, false), testing::HasSubstr("x…  1\nb      io "));
}

TEST(Table, RowWithFewerCells_IsFilledUp) {
    Table table({{"A"}, {"B"}});
    table.add({"1"});
    EXPECT_EQ(table.render(0, false), "A  B\n1\n");
}

}  // namespace
}  // namespace asip::cli
