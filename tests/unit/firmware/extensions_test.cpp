// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdio>

#include "fake_board.hpp"

namespace asip {
namespace {

std::string with_checksum(const std::string& line) {
    unsigned sum = 0;
    for (char c : line)
        sum ^= static_cast<unsigned char>(c);
    char end[8];
    std::snprintf(end, sizeof end, "*%02X", sum);
    return line + end;
}

TEST(ExtensionsTest, VerifiedFence_DigestsWhatWasReadSinceTheLast) {
    FakeBoard board;
    (void)board.ask("#,V,a");
    const auto alone = board.ask("#,V,a");
    EXPECT_EQ(alone, "@#,V,a,55845\n");
    (void)board.ask("I,d,13,1");
    EXPECT_EQ(board.ask("#,V,a"), "@#,V,a,4660\n");
    EXPECT_EQ(board.ask("#,V,a"), alone) << "it begins anew";
    (void)board.ask("I,d,13,0");
    EXPECT_NE(board.ask("#,V,a"), "@#,V,a,4660\n");
    (void)board.send("I,d,13,1 \r\n!debug\n\n");
    EXPECT_EQ(board.ask("#,V,a"), "@#,V,a,4660\n") << "what is no part of a request does not count";
    (void)board.send("I,d,99,1\n");
    EXPECT_EQ(board.ask("#,V,a"), "@#,V,a,37764\n") << "the number of the error is in it";
    EXPECT_EQ(board.ask("#,V,a-b"), "~#,V,11{BAD_ARGUMENT}\n");
}

TEST(ExtensionsTest, VerifiedFence_DigestsLinesWithoutTheirChecksums) {
    FakeBoard board;
    (void)board.ask("#,V,a");
    (void)board.ask("I,d,13,1");
    const auto plain = board.ask("#,V,a");
    (void)board.ask("#,C,1");
    (void)board.ask(with_checksum("#,V,a"));
    (void)board.ask(with_checksum("I,d,13,1"));
    (void)board.ask("I,d,13,1*00");
    EXPECT_EQ(board.ask(with_checksum("#,V,a")), with_checksum(plain.substr(0, plain.size() - 1)) + "\n");
}

TEST(ExtensionsTest, NameOf32Characters_IsTakenAndOf33Refused) {
    FakeBoard board;
    const std::string longest = "abcdefghijklmnopqrstuvwxyz._-XY9";
    ASSERT_EQ(longest.size(), 32u);
    EXPECT_EQ(board.ask("#,I," + longest), "@#,I," + longest + "\n");
    EXPECT_EQ(board.ask("#,I," + longest + "0"), "~#,I,11{BAD_ARGUMENT}\n");
    EXPECT_EQ(board.ask("#,I"), "@#,I," + longest + "\n");
}

TEST(ExtensionsTest, NameThatIsNoBoardName_IsRefusedAndNothingWritten) {
    FakeBoard board;
    for (const char* bad : {"#,I,", "#,I,a b", "#,I,a/b", "#,I,a,b", "#,I,$x"})
        EXPECT_EQ(board.ask(bad), "~#,I,11{BAD_ARGUMENT}\n") << bad;
    EXPECT_EQ(board.hardware().eeprom_writes, 0u);
}

TEST(ExtensionsTest, StoringAName_NeverWaitsForTheEeprom) {
    FakeBoard board;
    board.hardware().eeprom_ready = false;
    EXPECT_EQ(board.send("#,I,uno\n#,E,ok\n"), "");
    board.hardware().levels[2] = true;
    EXPECT_EQ(board.settle(), "@I,d,4,4\n");
    board.hardware().eeprom_ready = true;
    EXPECT_EQ(board.settle(), "@#,I,uno\n@#,E,ok\n");
}

TEST(ExtensionsTest, PowerLostWhileAName_IsStored_LeavesNoNameOrTheOldOne) {
    for (unsigned kept = 0; kept < 8; ++kept) {
        FakeBoard board;
        board.ask("#,I,first");
        const auto before = board.hardware().eeprom;
        board.ask("#,I,other");
        // The bytes that differ, in the order they were written: the name, the check, the length.
        auto cut = before;
        const std::size_t base = hw::kEepromEnd - 1 - kMaxNameLength;
        for (unsigned i = 0; i < kept && i < 5; ++i)
            cut[base + i] = board.hardware().eeprom[base + i];
        if (kept > 5) cut[hw::kEepromEnd] = board.hardware().eeprom[hw::kEepromEnd];
        FakeBoard later;
        later.hardware().eeprom = cut;
        const auto name = later.ask("#,I");
        EXPECT_TRUE(name == "@#,I,first\n" || name == "@#,I,\n" || name == "@#,I,other\n") << kept << name;
    }
}

TEST(ExtensionsTest, ForeignEepromContent_IsNoName) {
    for (unsigned fill : {0u, 0x20u, 0x41u, 0xFEu, 0xFFu}) {
        FakeBoard board;
        board.hardware().eeprom.fill(static_cast<std::uint8_t>(fill));
        EXPECT_EQ(board.ask("#,I"), "@#,I,\n") << fill;
    }
}

TEST(ExtensionsTest, NewRate_IsAnsweredAtTheOldOneThenUsed) {
    FakeBoard board;
    board.hardware().idle = false;
    EXPECT_EQ(board.ask("#,B,500000"), "@#,B,500000\n");
    EXPECT_EQ(board.hardware().baud, 57600u);
    board.hardware().idle = true;
    board.settle();
    EXPECT_EQ(board.hardware().baud, 500000u);
    EXPECT_EQ(board.ask("#,E,ok"), "@#,E,ok\n");
    board.pass_time(2000);
    EXPECT_EQ(board.hardware().baud, 500000u);
}

TEST(ExtensionsTest, FenceSentBeforeTheSwitch_DoesNotKeepTheNewRate) {
    FakeBoard board;
    board.send("#,B,500000\n#,E,early\n");
    EXPECT_EQ(board.hardware().baud, 500000u);
    board.pass_time(500);
    EXPECT_EQ(board.hardware().baud, 57600u);
}

TEST(ExtensionsTest, InfoWhileTheRateChanges_ComesAtTheNewRate) {
    FakeBoard board;
    board.hardware().to_board = "#,B,500000\n";
    asip::board.run();
    asip::board.info(F("hello"));
    EXPECT_EQ(board.hardware().baud, 500000u);
    EXPECT_EQ(board.settle(), "@#,B,500000\n!hello\n");
}

TEST(ExtensionsTest, RateThatIsNotAllowed_IsRefused) {
    FakeBoard board;
    for (const char* bad : {"#,B", "#,B,", "#,B,0", "#,B,57601", "#,B,2000000", "#,B,-57600", "#,B,500000x",
                            "#,B,4295467296", "#,B,99999999999999999999", "#,B,500000,1"}) {
        EXPECT_EQ(board.ask(bad), "~#,B,11{BAD_ARGUMENT}\n") << bad;
    }
    EXPECT_EQ(board.hardware().baud, 57600u);
}

TEST(ExtensionsTest, DefaultRate_NeedsNoFence) {
    FakeBoard board;
    board.ask("#,B,500000");
    board.ask("#,E,ok");
    board.ask("#,B,57600");
    EXPECT_EQ(board.hardware().baud, 57600u);
    board.pass_time(1000);
    EXPECT_EQ(board.ask("#,E,ok"), "@#,E,ok\n");
}

TEST(ExtensionsTest, Checksum_EndsEveryLineBothWays) {
    FakeBoard board;
    EXPECT_EQ(board.ask("#,C,1"), "");
    EXPECT_EQ(board.ask(with_checksum("#,E,ok")), with_checksum("@#,E,ok") + "\n");
    board.hardware().levels[2] = true;
    EXPECT_EQ(board.settle(), with_checksum("@I,d,4,4") + "\n");
    EXPECT_EQ(board.ask(with_checksum("I,m")),
              with_checksum("@I,m,6,{14:0,15:1,16:2,17:3,18:4,19:5}") + "\n");
    EXPECT_EQ(board.ask(with_checksum("#,C,0")), "");
    EXPECT_EQ(board.ask("#,E,ok"), "@#,E,ok\n");
}

TEST(ExtensionsTest, ChecksumInSmallLettersOrBeforeACarriageReturn_IsTaken) {
    FakeBoard board;
    board.ask("#,C,1");
    const auto line = with_checksum("I,P,13,3");
    EXPECT_EQ(board.send(line + "\r\n"), "");
    EXPECT_EQ(board.send("#,E,k*0d\n"), with_checksum("@#,E,k") + "\n");
}

TEST(ExtensionsTest, LineThatIsTooLong_HasNoChecksumWhateverItBeginsWith) {
    FakeBoard board;
    board.ask("#,C,1");
    EXPECT_EQ(board.ask("*00" + std::string(80, 'x')), with_checksum("~#,C,10{BAD_CHECKSUM}") + "\n");
    EXPECT_EQ(board.ask(with_checksum("#,E,a")), with_checksum("@#,E,a") + "\n");
}

}  // namespace
}  // namespace asip
