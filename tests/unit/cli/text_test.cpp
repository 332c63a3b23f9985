#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/text/duration.hpp"
#include "cli/text/line_template.hpp"
#include "cli/text/samples.hpp"
#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(DisplayWidth, AsciiAndUmlauts_CountOneEach) {
    EXPECT_EQ(display_width("uno1"), 4U);
    EXPECT_EQ(display_width("Küche"), 5U);
}

TEST(DisplayWidth, WideAndCombining_CountTwoAndNone) {
    EXPECT_EQ(display_width("温度"), 4U);
    EXPECT_EQ(display_width("e\u0301"), 1U);
}

TEST(DisplayWidth, BytesThatAreNoUtf8_CountOneEach) {
    EXPECT_EQ(display_width("\xff\xc3"), 2U);
    EXPECT_EQ(display_width("a\xe6\xb8"), 3U);
}

TEST(Fit, LongerThanColumns_CutsWholeCharactersAndMarks) {
    EXPECT_EQ(fit("distance", 5), "dist…");
    EXPECT_EQ(fit("温度計", 4), "温…");
    EXPECT_EQ(fit("uno1", 4), "uno1");
    EXPECT_EQ(fit("uno1", 0), "");
}

TEST(Printable, EscapeSequences_LoseTheirPower) {
    EXPECT_EQ(printable("\x1b[31mred\a"), "?[31mred?");
    EXPECT_EQ(printable("\u202Etxt"), "?txt");
    EXPECT_EQ(printable("gr\u00fcn"), "grün");
}

TEST(DurationText, GrowsCoarserWithLength) {
    EXPECT_EQ(duration_text(420us), "0.42 ms");
    EXPECT_EQ(duration_text(120ms), "120 ms");
    EXPECT_EQ(duration_text(3100ms), "3.1 s");
    EXPECT_EQ(duration_text(61s), "61 s");
    EXPECT_EQ(duration_text(59min), "59 min");
    EXPECT_EQ(duration_text(47h), "47 h");
    EXPECT_EQ(duration_text(240h), "10 d");
}

TEST(IsoTime, KnownInstant_IsWrittenInUtcWithMilliseconds) {
    EXPECT_EQ(iso_time(std::chrono::system_clock::time_point(1'700'000'000'042ms)),
              "2023-11-14T22:13:20.042Z");
}

TEST(ParseDuration, UnitsAndPlainSeconds_AreRead) {
    EXPECT_EQ(parse_duration("500ms"), 500ms);
    EXPECT_EQ(parse_duration("1.5"), 1500ms);
    EXPECT_EQ(parse_duration("2m"), 120s);
    EXPECT_EQ(parse_duration("0"), 0ms);
}

TEST(ParseDuration, NoNumberOrStrangeUnit_IsRefusedWithTheForms) {
    for (const auto* text : {"", "s", "5 parsec", "-1", "nan", "inf"}) {
        const auto result = parse_duration(text);
        ASSERT_FALSE(result) << text;
        EXPECT_THAT(result.error(), HasSubstr("500ms"));
    }
}

TEST(Samples, Percentiles_AreNearestRank) {
    Samples samples;
    for (int i = 100; i >= 1; --i)
        samples.add(i);
    EXPECT_EQ(samples.percentile(50), 50);
    EXPECT_EQ(samples.percentile(99), 99);
    EXPECT_EQ(samples.least(), 1);
    EXPECT_EQ(samples.greatest(), 100);
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

}  // namespace
}  // namespace asip::cli
