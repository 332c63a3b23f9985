// SPDX-License-Identifier: Apache-2.0
#include "asip/text/wall_time.hpp"

#include <gtest/gtest.h>

namespace asip::text {
namespace {

WallTime wall(std::int64_t milliseconds) {
    return WallTime(std::chrono::milliseconds(milliseconds));
}

TEST(IsoTime, KnownInstant_IsWrittenInUtcWithMilliseconds) {
    EXPECT_EQ(iso_time(wall(1'700'000'000'042)), "2023-11-14T22:13:20.042Z");
    EXPECT_EQ(iso_time(wall(0)), "1970-01-01T00:00:00.000Z");
    EXPECT_EQ(iso_time(wall(-1)), "1969-12-31T23:59:59.999Z");
    EXPECT_EQ(iso_time(wall(-62'167'219'200'000)), "0000-01-01T00:00:00.000Z");
    EXPECT_EQ(iso_time(wall(253'402'300'799'999)), "9999-12-31T23:59:59.999Z");
}

TEST(ParseIsoTime, WhatIsoTimeWrites_IsReadBack) {
    for (const std::int64_t at : {0ll, 1ll, 951'782'400'000ll, 1'700'000'000'123ll, 4'102'444'799'999ll})
        EXPECT_EQ(parse_iso_time(iso_time(wall(at))), wall(at));
}

TEST(ParseIsoTime, WhatIsCutShort_IsTheFirstMomentOfIt) {
    for (const auto& [text, whole] : {std::pair{"2023-11-14", "2023-11-14T00:00:00.000Z"},
                                      {"2023-11-14T22:13", "2023-11-14T22:13:00.000Z"},
                                      {"2023-11-14T22:13Z", "2023-11-14T22:13:00.000Z"},
                                      {"2023-11-14T22:13:20Z", "2023-11-14T22:13:20.000Z"},
                                      {"2023-11-14T22:13:20.123", "2023-11-14T22:13:20.123Z"}})
        EXPECT_EQ(parse_iso_time(text), parse_iso_time(whole)) << text;
}

TEST(ParseIsoTime, AnythingElse_IsNothing) {
    for (const char* bad :
         {"", "Z", "2023-11", "2023-11-14T22", "2023-13-14", "2023-13-14T22:13:20.123Z",
          "2023-02-29T22:13:20.123Z", "2023-11-14T24:13:20.123Z", "2023-11-14T22:13:20.12xZ",
          "2023-11-14T22:13:20.12Z", "2023-11-14T22:13:20.123ZZ", "2023-11-14T22:13:20.123Zx",
          "-023-11-14T22:13:20.123Z", "2023-11-14 22:13"}) {
        EXPECT_FALSE(parse_iso_time(bad)) << bad;
    }
}

}  // namespace
}  // namespace asip::text
