// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/utf_frame.hpp"

#include <gmock/gmock.h>

namespace asip::protocol {
namespace {

using namespace std::string_literals;
using testing::ElementsAre;
using testing::IsEmpty;

struct UtfFrameReaderTest : testing::Test {
    std::vector<std::string> push(std::string_view bytes) {
        std::vector<std::string> frames;
        reader.push(bytes, [&](std::string_view frame) { frames.emplace_back(frame); });
        return frames;
    }

    UtfFrameReader reader{300};
};

TEST_F(UtfFrameReaderTest, TooLongForBuffer_SkipsFrameAndRecovers) {
    EXPECT_THAT(push("\xff\xff"s + std::string(65535, 'x') + "\0\2ok"s), ElementsAre("ok"));
}

TEST(EncodeUtfFrame, Text_GetsItsLengthBeforeIt) {
    EXPECT_EQ(encode_utf_frame("I,M").value(), "\0\3I,M"s);
    EXPECT_EQ(encode_utf_frame(std::string(258, 'x'))->substr(0, 3), "\1\2x"s);
}

TEST(EncodeUtfFrame, TextOfPeople_IsUtf8AndWhatJavaEncodesOtherwiseAQuestionMark) {
    EXPECT_EQ(encode_utf_frame("K\xc3\xbc\xe2\x82\xac").value(), "\0\6K\xc3\xbc\xe2\x82\xac"s);
    EXPECT_EQ(encode_utf_frame("a\0b"s).value(), "\0\3a?b"s);
    EXPECT_EQ(encode_utf_frame("\xf0\x9f\x99\x82x").value(), "\0\5????x"s);
    for (const auto* bad : {"\xc3", "\xff", "\xc0\x80", "\xed\xa0\x80", "\xe0\x80\x80", "\xe2\x82"}) {
        const auto frame = encode_utf_frame(bad).value();
        EXPECT_EQ(frame.substr(2), std::string(std::string(bad).size(), '?'));
        EXPECT_EQ(static_cast<std::size_t>(frame[1]), frame.size() - 2);
    }
    EXPECT_TRUE(encode_utf_frame(std::string(65535, 'x')));
    EXPECT_FALSE(encode_utf_frame(std::string(65536, 'x')));
}

TEST(StartsUtfFrame, FirstByte_DistinguishesFramesFromLines) {
    EXPECT_TRUE(starts_utf_frame(0));
    for (const char c : {'I', '#', '!', '\n', '\r', '\t', ' ', '\x1b'})
        EXPECT_FALSE(starts_utf_frame(static_cast<unsigned char>(c))) << c;
}

}  // namespace
}  // namespace asip::protocol
