// SPDX-License-Identifier: Apache-2.0
#include "asip/text/printable.hpp"

#include <gtest/gtest.h>

namespace asip::text {
namespace {

TEST(Printable, ControlAndForeignBytes_AreEscaped) {
    EXPECT_EQ(printable("a b~"), "a b~");
    EXPECT_EQ(printable("\x1b[2J\xc3\\"), "\\x1b[2J\\xc3\\x5c");
    EXPECT_EQ(printable("abcdef", 3), "abc...");
}

TEST(EscapeControls, Utf8_IsKeptAndControlsAreEscaped) {
    EXPECT_EQ(escape_controls("gr\u00fcn \u20ac"), "gr\u00fcn \u20ac");
    EXPECT_EQ(escape_controls("a\nb\x7f"), "a\\x0ab\\x7f");
    EXPECT_EQ(escape_controls("\u009b2J"), "\\xc2\\x9b2J");
}

/// A mark turns the order of what follows: "status=denied" would be read as something else.
TEST(EscapeControls, MarksThatNoOneSees_AreEscaped) {
    for (const std::string_view mark :
         {"\u061c", "\u200b", "\u200e", "\u200f", "\u202a", "\u202b", "\u202c", "\u202d", "\u202e", "\u2066",
          "\u2067", "\u2068", "\u2069", "\u2028", "\ufeff"}) {
        const auto shown = escape_controls("a" + std::string(mark) + "b");
        EXPECT_TRUE(shown.starts_with("a\\x")) << shown;
        EXPECT_TRUE(shown.ends_with("b")) << shown;
        EXPECT_EQ(shown.find(mark), std::string::npos) << shown;
        EXPECT_EQ(escape_json("\"" + std::string(mark) + "\"").find(mark), std::string::npos);
        EXPECT_TRUE(begins_unseen(mark));
    }
    EXPECT_EQ(escape_json("\"\u061c\""), R"("\u061c")");
    EXPECT_EQ(escape_controls("\u0627\u0644 \u061f \u2010"), "\u0627\u0644 \u061f \u2010")
        << "letters and signs stay";
}

TEST(EscapeControls, AnyPairOfBytes_BecomesShowable) {
    for (int first = 0; first < 256; ++first) {
        for (int second = 0; second < 256; ++second) {
            const std::string pair{static_cast<char>(first), static_cast<char>(second)};
            ASSERT_TRUE(is_showable(escape_controls(pair))) << first << " " << second;
        }
    }
}

TEST(EscapeJson, WhatATerminalObeysOrNoOneSees_IsEscapedAndNothingElse) {
    const std::string plain = "{\n  \"a\": \"Gr\u00f6\u00dfe \u20ac \\u001b\"\n}";
    EXPECT_EQ(escape_json(plain), plain);
    EXPECT_EQ(escape_json("\"\u009b31m\x7f\u202e\ufeff\u200b\u2060z\""),
              R"("\u009b31m\u007f\u202e\ufeff\u200b\u2060z")");
    EXPECT_EQ(escape_json("\xc2"), "\xc2");
    EXPECT_EQ(escape_json(""), "");
}

TEST(IsShowable, ControlCharacters_AreNot) {
    EXPECT_TRUE(is_showable("Gr\u00f6\u00dfe \u20ac"));
    for (const std::string_view text : {"\x1b[2J", "a\nb", "\x7f", "\u009b2J"})
        EXPECT_FALSE(is_showable(text));
    EXPECT_FALSE(is_showable(std::string_view("a\0", 2)));
}

}  // namespace
}  // namespace asip::text
