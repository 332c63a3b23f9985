// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asip/text/wall_time.hpp"
#include "cli/text/line_template.hpp"
#include "cli/text/moment.hpp"
#include "cli/text/samples.hpp"
#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

using ::testing::ElementsAre;

TEST(DisplayWidth, AsciiAndUmlauts_CountOneEach) {
    EXPECT_EQ(display_width("uno1"), 4U);
    EXPECT_EQ(display_width("Küche"), 5U);
}

TEST(DisplayWidth, WideAndCombining_CountTwoAndNone) {
    EXPECT_EQ(display_width("温度"), 4U);
    EXPECT_EQ(display_width("e\u0301"), 1U);
}

TEST(DisplayWidth, MarksOfHebrewArabicAndThai_CountNone) {
    EXPECT_EQ(display_width("\u05E9\u05C1\u05B8\u05DC"), 2U);
    EXPECT_EQ(display_width("\u0645\u064F\u062D\u064E"), 2U);
    EXPECT_EQ(display_width("\u0E01\u0E35\u0E48"), 1U);
}

TEST(DisplayWidth, OverlongForms_AreNotUtf8) {
    EXPECT_EQ(display_width("\xE0\x80\xAF"), 3U);
    EXPECT_EQ(for_terminal("\xE0\x80\xAF"), "???");
    EXPECT_EQ(for_terminal("\xC0\xAF"), "??");
    EXPECT_EQ(for_terminal("\xED\xA0\x80"), "???") << "half of a surrogate pair";
}

TEST(DisplayWidth, BytesThatAreNotUtf8_CountOneEach) {
    EXPECT_EQ(display_width("\xff\xc3"), 2U);
    EXPECT_EQ(display_width("a\xe6\xb8"), 3U);
}

TEST(Fit, LongerThanColumns_CutsWholeCharactersAndMarks) {
    EXPECT_EQ(fit("distance", 5), "dist…");
    EXPECT_EQ(fit("温度計", 4), "温…");
    EXPECT_EQ(fit("uno1", 4), "uno1");
    EXPECT_EQ(fit("uno1", 0), "");
}

TEST(ForTerminal, EscapeSequences_LoseTheirPower) {
    EXPECT_EQ(for_terminal("\x1b[31mred\a"), "?[31mred?");
    EXPECT_EQ(for_terminal("\u202Etxt"), "?txt");
    EXPECT_EQ(for_terminal("gr\u00fcn"), "grün");
}

TEST(Samples, Percentiles_AreNearestRank) {
    Samples samples;
    for (int i = 100; i >= 1; --i)
        samples.add(i);
    EXPECT_EQ(samples.percentile(50), 50);
    EXPECT_EQ(samples.percentile(99), 99);
    EXPECT_EQ(samples.minimum(), 1);
    EXPECT_EQ(samples.maximum(), 100);
    EXPECT_DOUBLE_EQ(samples.mean(), 50.5);
}

TEST(Samples, NoneOrOne_AreAnsweredWithoutFuss) {
    Samples samples;
    EXPECT_EQ(samples.percentile(99), 0);
    samples.add(7);
    EXPECT_EQ(samples.percentile(1), 7);
    EXPECT_EQ(samples.percentile(99), 7);
}

TEST(LineTemplate, PlacesEscapesAndBraces_AreFilled) {
    const auto line = LineTemplate::parse("{{{board}}}\\t{data.x}\\n");
    ASSERT_TRUE(line) << line.error();
    EXPECT_THAT(line->names(), ElementsAre("board", "data.x"));
    EXPECT_EQ(line->fill([](std::string_view name) { return "<" + std::string(name) + ">"; }),
              "{<board>}\t<data.x>\n");
}

TEST(LineTemplate, BracesThatDoNotPair_AreRefused) {
    EXPECT_FALSE(LineTemplate::parse("{board"));
    EXPECT_FALSE(LineTemplate::parse("board}"));
    EXPECT_FALSE(LineTemplate::parse("{}"));
}

TEST(ParseMoment, AgoOrATimeCutShort_IsRead) {
    const auto now = *text::parse_iso_time("2026-11-22T12:00:00.000Z");
    const auto read = [now](std::string_view text) {
        const auto moment = parse_moment(text, now);
        return moment ? text::iso_time(*moment) : moment.error();
    };
    EXPECT_EQ(read("10m"), "2026-11-22T11:50:00.000Z");
    EXPECT_EQ(read("2026-11-21"), "2026-11-21T00:00:00.000Z");
    EXPECT_EQ(read("2026-11-21T10:30"), "2026-11-21T10:30:00.000Z");
    EXPECT_EQ(read("2026-11-21T10:30:01Z"), "2026-11-21T10:30:01.000Z");
    EXPECT_EQ(read("2026-11-21T10:30:01.007Z"), "2026-11-21T10:30:01.007Z");
    for (const auto* bad : {"", "Z", "yesterday", "2026-11-31", "2026-11-21T1", "2026-11-21T10:30:01.007Zx"})
        EXPECT_THAT(read(bad), ::testing::HasSubstr("neither")) << bad;
}

}  // namespace
}  // namespace asip::cli
