// SPDX-License-Identifier: Apache-2.0
// Requests of more than 62 characters, on a board with a service that asks for them.
#include <gtest/gtest.h>

#include <array>

#include "fake_board.hpp"

namespace asip {
namespace {

constexpr std::size_t kLongest = 172;

/// Takes any text, and keeps it.
class Writer : public Service {
  public:
    Writer() : Service('W', 1) {}
    FlashText name() const override { return F("Writer"); }
    void begin() override { board.useLongLines(line_.data(), static_cast<std::uint8_t>(line_.size())); }
    Error processRequest(Request& request) override {
        written = request.text();
        return Error::kNone;
    }
    void reportValue(std::uint8_t) override { out.number(1); }
    std::string written;

  private:
    std::array<char, kLongest + kBehindRequest> line_{};
};

std::string checked(const std::string& line) {
    unsigned sum = 0;
    for (const char c : line)
        sum ^= static_cast<unsigned char>(c);
    std::array<char, 8> tail{};
    std::snprintf(tail.data(), tail.size(), "*%02X", sum);
    return line + tail.data();
}

TEST(LongLinesTest, BoardWithoutSuchAService_SaysNothingAndTakes63) {
    FakeBoard board;
    EXPECT_EQ(board.ask("#,X"), "@#,X,7,{E:1,I:1,B:1,C:1,V:1,D:1,F:2}\n");
    EXPECT_EQ(board.ask("I,x," + std::string(59, '1')), "~I,x,2{UNKNOWN_REQUEST}\n");
    EXPECT_EQ(board.ask("I,x," + std::string(60, '1')), "~I,x,11{BAD_ARGUMENT}\n");
}

TEST(LongLinesTest, BoardWithOne_NamesTheLengthAndTakesIt) {
    Writer writer;
    FakeBoard board({&writer});
    EXPECT_EQ(board.ask("#,X"), "@#,X,8,{L:172,E:1,I:1,B:1,C:1,V:1,D:1,F:2}\n");
    const std::string text(kLongest - 4, 'x');
    EXPECT_EQ(board.ask("W,t," + text), "");
    EXPECT_EQ(writer.written, text);
    EXPECT_EQ(board.ask("#,E,ok"), "@#,E,ok\n");
}

TEST(LongLinesTest, LongestRequestWithItsChecksum_IsTaken) {
    Writer writer;
    FakeBoard board({&writer});
    board.ask("#,C,1");
    const std::string text(kLongest - 4, 'x');
    EXPECT_EQ(board.ask(checked("W,t," + text)), "");
    EXPECT_EQ(writer.written, text);
    EXPECT_EQ(board.ask("W,t," + text + "*00"), checked("~#,C,10{BAD_CHECKSUM}") + "\n");
}

TEST(LongLinesTest, LineThatIsTooLong_IsRefusedAndTheNextWorks) {
    Writer writer;
    FakeBoard board({&writer});
    for (const std::size_t length : {176u, 255u, 256u, 1000u}) {
        EXPECT_EQ(board.ask("W,t," + std::string(length - 4, 'x')), "~W,t,11{BAD_ARGUMENT}\n") << length;
        EXPECT_EQ(writer.written, "");
        EXPECT_EQ(board.ask("#,E,ok"), "@#,E,ok\n");
    }
}

TEST(LongLinesTest, DamagedByte_SpoilsItsLineOnlyAndNamesItAsFarAsItCame) {
    Writer writer;
    FakeBoard board({&writer});
    const std::string zero(1, '\0');
    EXPECT_EQ(board.send("W,t," + std::string(150, 'x') + zero + "x\n"), "~W,t,11{BAD_ARGUMENT}\n");
    EXPECT_EQ(board.send("W,t" + zero + "\n"), "~W,t,11{BAD_ARGUMENT}\n");
    EXPECT_EQ(board.send("W," + zero + "\n"), "~W,?,11{BAD_ARGUMENT}\n");
    EXPECT_EQ(board.send("W" + zero + "t,1\n"), "~W,?,11{BAD_ARGUMENT}\n");
    EXPECT_EQ(board.send(zero + "\n"), "");
    EXPECT_EQ(writer.written, "");
    EXPECT_EQ(board.ask("W,t,good"), "");
    EXPECT_EQ(writer.written, "good");
}

TEST(LongLinesTest, RequestWhileTheLineIsBusy_IsReadAndExecutedAfterwards) {
    Writer writer;
    FakeBoard board({&writer});
    board.hardware().room = 0;
    board.hardware().to_board = "W,t," + std::string(150, 'x') + "\n" + "#,E,ok\n";
    asip::board.run();
    EXPECT_EQ(board.hardware().to_board, "#,E,ok\n");
    EXPECT_EQ(writer.written, "") << "its answer would not have room";
    board.hardware().room = 63;
    EXPECT_EQ(board.settle(), "@#,E,ok\n");
    EXPECT_EQ(writer.written.size(), 150u);
}

TEST(LongLinesTest, RequestsDuringAList_AreExecutedBehindItInOrder) {
    Writer writer;
    FakeBoard board({&writer});
    const auto sent = board.send("I,p\nW,t,first\n#,E,a\n#,I,desk\n#,E,b\n");
    EXPECT_EQ(sent.substr(sent.find('\n')), "\n@#,E,a\n@#,I,desk\n@#,E,b\n");
    EXPECT_EQ(writer.written, "first");
}

TEST(LongLinesTest, Restart_KeepsTheBuffer) {
    Writer writer;
    FakeBoard board({&writer});
    EXPECT_EQ(board.send("#,R\nW,t," + std::string(100, 'x') + "\n"), "");
    EXPECT_EQ(writer.written.size(), 100u);
}

}  // namespace
}  // namespace asip
