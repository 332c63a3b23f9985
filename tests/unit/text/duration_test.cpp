// SPDX-License-Identifier: Apache-2.0
#include "asip/text/duration.hpp"

#include <gtest/gtest.h>

namespace asip::text {
namespace {

using namespace std::chrono_literals;

TEST(ParseDuration, EachUnit_IsRead) {
    EXPECT_EQ(parse_duration("500ms"), 500ms);
    EXPECT_EQ(parse_duration("10s"), 10s);
    EXPECT_EQ(parse_duration("2m"), 120s);
    EXPECT_EQ(parse_duration("12h"), 12h);
    EXPECT_EQ(parse_duration("7d"), 168h);
    EXPECT_EQ(parse_duration("1.5"), 1500ms);
    EXPECT_EQ(parse_duration("1.5h"), 90min);
    EXPECT_EQ(parse_duration("0"), 0ms);
}

TEST(ParseDuration, NoNumberOrStrangeUnit_IsRefusedWithTheForms) {
    for (const auto* text : {"", "s", "5 parsec", "nan", "inf", "1e3", "5 s", "0x5", "5S", "+5"}) {
        const auto result = parse_duration(text);
        ASSERT_FALSE(result) << text;
        EXPECT_NE(result.error().find("500ms, 10s, 15m, 12h, 7d"), std::string::npos) << result.error();
    }
}

TEST(ParseDuration, OutsideZeroToHundredYears_IsRefused) {
    EXPECT_TRUE(parse_duration("36600d"));
    for (const auto* text : {"-1", "-0.5s", "36601d", "99999999999999999999d"}) {
        const auto result = parse_duration(text);
        ASSERT_FALSE(result) << text;
        EXPECT_NE(result.error().find("0 to 100 years"), std::string::npos) << result.error();
    }
}

TEST(DurationText, GrowsCoarserWithLength) {
    EXPECT_EQ(duration_text(420us), "0.42 ms");
    EXPECT_EQ(duration_text(120ms), "120 ms");
    EXPECT_EQ(duration_text(3100ms), "3.1 s");
    EXPECT_EQ(duration_text(61s), "61 s");
    EXPECT_EQ(duration_text(59min), "59 min");
    EXPECT_EQ(duration_text(47h), "47 h");
    EXPECT_EQ(duration_text(240h), "10 d");
    EXPECT_EQ(duration_text(36600 * 24h), "36600 d");
}

TEST(DurationText, WhatNoClockMeasures_IsOver100Years) {
    using Seconds = std::chrono::duration<double>;
    for (const double seconds : {1e308, -1e308, HUGE_VAL, std::nan(""), 36601 * 86400.0})
        EXPECT_EQ(duration_text(Seconds(seconds)), "over 100 years") << seconds;
}

}  // namespace
}  // namespace asip::text
