// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/line_reader.hpp"

#include <gmock/gmock.h>

namespace asip::protocol {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

struct LineReaderTest : testing::Test {
    std::vector<std::string> push(std::string_view bytes) {
        std::vector<std::string> lines;
        reader.push(bytes, [&](std::string_view line) { lines.emplace_back(line); });
        return lines;
    }

    LineReader reader{8};
};

TEST_F(LineReaderTest, LineArrivingByteByByte_IsGivenOnceAtItsEnd) {
    for (const char c : std::string_view("@D,e"))
        EXPECT_THAT(push({&c, 1}), IsEmpty());
    EXPECT_EQ(reader.partial(), "@D,e");
    EXPECT_THAT(push("\n"), ElementsAre("@D,e"));
    EXPECT_EQ(reader.partial_bytes(), 0u);
}

TEST_F(LineReaderTest, SeveralLinesInOneRead_AreGivenInOrder) {
    EXPECT_THAT(push("a\nbb\nc"), ElementsAre("a", "bb"));
    EXPECT_THAT(push("c\n"), ElementsAre("cc"));
}

TEST_F(LineReaderTest, CarriageReturnBeforeNewline_IsDropped) {
    EXPECT_THAT(push("a\r\n\r\n\nb\r"), ElementsAre("a"));
    EXPECT_THAT(push("\n"), ElementsAre("b"));
}

TEST_F(LineReaderTest, CarriageReturnInsideLine_IsKept) {
    EXPECT_THAT(push("a\rb\n"), ElementsAre("a\rb"));
}

TEST_F(LineReaderTest, LineOfExactlyTheLimit_IsGivenWithAndWithoutCarriageReturn) {
    EXPECT_THAT(push("12345678\n12345678\r\n"), ElementsAre("12345678", "12345678"));
    EXPECT_EQ(reader.overlong_lines(), 0u);
}

TEST_F(LineReaderTest, TooLongForBuffer_DropsLineAndRecovers) {
    EXPECT_THAT(push("123456789\nok\n"), ElementsAre("ok"));
    EXPECT_EQ(reader.overlong_lines(), 1u);
}

TEST_F(LineReaderTest, NoNewlineForMegabytes_HoldsNoMoreThanTheLimitAndRecovers) {
    const std::string noise(1000, 'x');
    for (int i = 0; i < 1000; ++i) {
        EXPECT_THAT(push(noise), IsEmpty());
        EXPECT_LE(reader.partial_bytes(), 9u);
    }
    EXPECT_THAT(push("\nok\n"), ElementsAre("ok"));
    EXPECT_EQ(reader.overlong_lines(), 1u);
}

TEST_F(LineReaderTest, Reset_ForgetsThePartialLine) {
    push("half");
    reader.reset();
    EXPECT_THAT(push("ok\n"), ElementsAre("ok"));
}

TEST_F(LineReaderTest, ResetWhileDropping_TakesTheNextLine) {
    push("123456789012");
    reader.reset();
    EXPECT_THAT(push("ok\n"), ElementsAre("ok"));
}

TEST_F(LineReaderTest, BinaryBytes_PassThrough) {
    EXPECT_THAT(push(std::string_view("\0\xff\n", 3)), ElementsAre(std::string("\0\xff", 2)));
}

}  // namespace
}  // namespace asip::protocol
