// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/quirks/delivers_no_qos_1.hpp"

#include <gtest/gtest.h>

namespace asip::mqtt {
namespace {

using namespace std::chrono_literals;

constexpr Time kStillStart{100s};

class StandStillTest : public testing::Test {
  protected:
    StandStillTest() { watch.restart(kStillStart); }
    void first_comes(Time now) {
        watch.sent(now);
        watch.came(0, now);
    }

    StandStill watch{60s};
};

TEST_F(StandStillTest, FirstWithQos0_ThenWithQos1AndSoOn) {
    EXPECT_EQ(watch.due(kStillStart + 59s), std::nullopt);
    EXPECT_EQ(watch.due(kStillStart + 60s), 0);
    watch.sent(kStillStart + 60s);
    EXPECT_EQ(watch.due(kStillStart + 70s), std::nullopt) << "one is under way";
    watch.came(0, kStillStart + 61s);
    EXPECT_EQ(watch.due(kStillStart + 61s), 1);
    watch.sent(kStillStart + 61s);
    watch.came(1, kStillStart + 62s);
    EXPECT_EQ(watch.due(kStillStart + 121s), std::nullopt);
    EXPECT_EQ(watch.due(kStillStart + 122s), 0);
    EXPECT_FALSE(watch.found(kStillStart + 1h));
}

TEST_F(StandStillTest, OnlyTheSecondIsMissing_IsFound) {
    first_comes(kStillStart + 60s);
    watch.sent(kStillStart + 60s);
    EXPECT_FALSE(watch.found(kStillStart + 69s));
    EXPECT_TRUE(watch.found(kStillStart + 70s));
    watch.restart(kStillStart + 71s);
    EXPECT_FALSE(watch.found(kStillStart + 1h)) << "another connection";
    EXPECT_EQ(watch.due(kStillStart + 131s), 0);
}

TEST_F(StandStillTest, BothAreMissing_IsNotOurMatter) {
    watch.sent(kStillStart + 60s);
    EXPECT_FALSE(watch.found(kStillStart + 1h)) << "rules may deny it, or the broker is slow";
    EXPECT_EQ(watch.due(kStillStart + 1h), std::nullopt);
}

TEST_F(StandStillTest, OthersComeOrWeAreBehind_WaitsOn) {
    first_comes(kStillStart + 60s);
    watch.sent(kStillStart + 60s);
    watch.heard(kStillStart + 69s);
    EXPECT_FALSE(watch.found(kStillStart + 78s));
    watch.behind(kStillStart + 78s);
    EXPECT_FALSE(watch.found(kStillStart + 87s));
    EXPECT_TRUE(watch.found(kStillStart + 88s));
}

TEST_F(StandStillTest, LateOneOfAnEarlierConnection_CountsForNothing) {
    watch.came(1, kStillStart);
    watch.came(0, kStillStart);
    EXPECT_EQ(watch.due(kStillStart + 1s), std::nullopt);
}

TEST(StandStill, Never_IsNever) {
    StandStill watch(0s);
    watch.restart(kStillStart);
    EXPECT_EQ(watch.due(kStillStart + 1h), std::nullopt);
}

}  // namespace
}  // namespace asip::mqtt
