// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdio>

#include "asip/Digest.h"
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

TEST(ExtensionsTest, List_NamesTheSix) {
    FakeBoard board;
    EXPECT_EQ(board.ask("#,X"), "@#,X,6,{E:1,I:1,B:1,C:1,V:1,D:1}\n");
    EXPECT_EQ(board.ask("#,X,1"), "~#,X,11{BAD_ARGUMENT}\n");
    EXPECT_EQ(board.ask("#,Y"), "~#,Y,2{UNKNOWN_REQUEST}\n");
}

TEST(ExtensionsTest, Echo_TakesOneToEightLettersOrDigits) {
    FakeBoard board;
    EXPECT_EQ(board.ask("#,E,a"), "@#,E,a\n");
    EXPECT_EQ(board.ask("#,E,Abc12345"), "@#,E,Abc12345\n");
    for (const char* bad : {"#,E", "#,E,", "#,E,123456789", "#,E,a-b", "#,E,a b", "#,E,a,b"})
        EXPECT_EQ(board.ask(bad), "~#,E,11{BAD_ARGUMENT}\n") << bad;
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

TEST(ExtensionsTest, VerifiedFence_DigestsTheErrorThatWasSent) {
    // A request to a service that is not there, or without a tag, has two errors and gets one answer.
    FakeBoard board;
    for (const char* line : {"Z", "Zz", "Z,x1", "Z,x,1"}) {
        (void)board.ask("#,V,a");
        EXPECT_EQ(board.ask(line), "~Z,?,1{INVALID_SERVICE}\n");
        std::uint16_t digest = 0;
        for (const char* c = line; *c != '\0'; ++c)
            digest = digestOf(digest, static_cast<std::uint8_t>(*c));
        digest = static_cast<std::uint16_t>(digestOf(digest, 0) ^ 1);
        for (const char c : std::string("#,V,a"))
            digest = digestOf(digest, static_cast<std::uint8_t>(c));
        EXPECT_EQ(board.ask("#,V,a"), "@#,V,a," + std::to_string(digestOf(digest, 0)) + "\n") << line;
    }
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

TEST(ExtensionsTest, Name_IsEmptyUntilStoredAndThenKept) {
    FakeBoard board;
    EXPECT_EQ(board.ask("#,I"), "@#,I,\n");
    EXPECT_EQ(board.ask("#,I,uno-1"), "@#,I,uno-1\n");
    EXPECT_EQ(board.ask("#,I"), "@#,I,uno-1\n");
    const auto eeprom = board.hardware().eeprom;
    FakeBoard later;
    later.hardware().eeprom = eeprom;
    EXPECT_EQ(later.ask("#,I"), "@#,I,uno-1\n");
    EXPECT_EQ(later.ask("#,I,ab"), "@#,I,ab\n");
    EXPECT_EQ(later.ask("#,I"), "@#,I,ab\n");
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

TEST(ExtensionsTest, NewRateWithoutAFence_FallsBackAfter500Milliseconds) {
    FakeBoard board;
    board.ask("#,B,1000000");
    EXPECT_EQ(board.ask("#,?"), "@#,?,0,4,ATmega328P,20,Test\n");
    EXPECT_EQ(board.ask("#,E,not-good"), "~#,E,11{BAD_ARGUMENT}\n");
    board.pass_time(499);
    EXPECT_EQ(board.hardware().baud, 1000000u);
    board.send("#,E,rubbi");
    board.pass_time(1);
    EXPECT_EQ(board.hardware().baud, 57600u);
    EXPECT_EQ(board.ask("#,E,ok"), "@#,E,ok\n");
}

TEST(ExtensionsTest, FenceSentBeforeTheSwitch_DoesNotKeepTheNewRate) {
    FakeBoard board;
    board.send("#,B,500000\n#,E,early\n");
    EXPECT_EQ(board.hardware().baud, 500000u);
    board.pass_time(500);
    EXPECT_EQ(board.hardware().baud, 57600u);
}

TEST(ExtensionsTest, NameThatIsStoredWhileReportsAreDue_IsStoredAndAnswered) {
    FakeBoard board;
    board.ask("I,A,1");
    board.hardware().to_board = "#,I,living-room\n";
    std::string all;
    for (int ms = 0; ms < 200; ++ms) {
        board.hardware().eeprom_ready = ms % 4 == 0;
        all += board.pass_time(1);
    }
    EXPECT_NE(all.find("@#,I,living-room\n"), std::string::npos);
    EXPECT_NE(all.find("@I,a,6,{0:0,"), std::string::npos);
    board.hardware().eeprom_ready = true;
    board.ask("I,A,0");
    EXPECT_EQ(board.ask("#,I"), "@#,I,living-room\n");
}

TEST(ExtensionsTest, NewRateWhileReportsAreDue_IsSwitchedToWithNothingInBetween) {
    FakeBoard board;
    board.ask("I,A,1");
    board.pass_time(3);
    board.hardware().idle = false;
    board.hardware().to_board = "#,B,500000\n";
    asip::board.run();
    board.hardware().levels[2] = true;
    const auto before = board.pass_time(20);
    EXPECT_EQ(before.substr(before.size() - 12), "@#,B,500000\n") << before;
    EXPECT_EQ(board.hardware().baud, 57600u);
    board.hardware().idle = true;
    const auto after = board.pass_time(2);
    EXPECT_EQ(board.hardware().baud, 500000u);
    EXPECT_NE(after.find("@I,d,4,4\n"), std::string::npos) << after;
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

TEST(ExtensionsTest, BadChecksum_IsReportedAndNothingExecuted) {
    FakeBoard board;
    board.ask("I,P,13,3");
    board.ask("#,C,1");
    const auto error = with_checksum("~#,C,10{BAD_CHECKSUM}") + "\n";
    for (const char* bad : {"I,d,13,1", "I,d,13,1*", "I,d,13,1*0", "I,d,13,1*00", "I,d,13,1*GG", "*", "x"})
        EXPECT_EQ(board.ask(bad), error) << bad;
    EXPECT_FALSE(board.hardware().levels[13]);
    EXPECT_EQ(board.ask(with_checksum("I,d,13,1")), "");
    EXPECT_TRUE(board.hardware().levels[13]);
}

TEST(ExtensionsTest, LineThatIsTooLong_HasNoChecksumWhateverItBeginsWith) {
    FakeBoard board;
    board.ask("#,C,1");
    EXPECT_EQ(board.ask("*00" + std::string(80, 'x')), with_checksum("~#,C,10{BAD_CHECKSUM}") + "\n");
    EXPECT_EQ(board.ask(with_checksum("#,E,a")), with_checksum("@#,E,a") + "\n");
}

TEST(ExtensionsTest, EverySingleDamagedCharacter_IsCaughtByTheChecksum) {
    FakeBoard board;
    board.ask("I,P,13,3");
    board.ask("#,C,1");
    const auto good = with_checksum("I,d,13,1");
    for (std::size_t at = 0; at < good.size(); ++at) {
        for (int bit = 0; bit < 8; ++bit) {
            auto bad = good;
            bad[at] = static_cast<char>(bad[at] ^ (1 << bit));
            if (bad[at] == '\n' || bad[0] == '!' || (at >= good.size() - 2 && bit == 5)) continue;
            board.ask(bad);
            ASSERT_FALSE(board.hardware().levels[13]) << bad;
        }
    }
}

TEST(ExtensionsTest, ChecksumArgument_IsZeroOrOne) {
    FakeBoard board;
    for (const char* bad : {"#,C", "#,C,", "#,C,2", "#,C,on"})
        EXPECT_EQ(board.ask(bad), "~#,C,11{BAD_ARGUMENT}\n") << bad;
}

}  // namespace
}  // namespace asip
