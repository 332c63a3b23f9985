// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/quirks/closes_when_denied.hpp"

#include <gmock/gmock.h>

namespace asip::mqtt {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

class ClosesWhenDeniedTest : public testing::Test {
  protected:
    ConnectionFailure ended(Duration up, Duration after_message, int code = 0) {
        now_ += up;
        closes_.sent(now_ - after_message);
        ConnectionFailure failure{ConnectionFailure::Kind::kClosed, {}, code, "closed the connection"};
        closes_.ended(failure, up, "uno1", now_);
        return failure;
    }
    ClosesWhenDenied closes_;
    Time now_{100s};
};

TEST_F(ClosesWhenDeniedTest, ThreeTimesInARow_IsSaidWithTheUser) {
    EXPECT_EQ(ended(1s, 10ms).after_sending, 1U);
    EXPECT_THAT(ended(1s, 10ms).text, Not(HasSubstr("access rules")));
    const auto third = ended(1s, 10ms);
    EXPECT_EQ(third.after_sending, 3U);
    EXPECT_THAT(third.text, HasSubstr("3 times in a row"));
    EXPECT_THAT(third.text, HasSubstr("user \"uno1\""));
}

TEST_F(ClosesWhenDeniedTest, ConnectionThatLasted_BeginsAnew) {
    ended(1s, 10ms);
    ended(1s, 10ms);
    EXPECT_EQ(ended(11s, 10ms).after_sending, 0U);
    EXPECT_EQ(ended(1s, 10ms).after_sending, 1U);
}

TEST_F(ClosesWhenDeniedTest, LongAfterAMessageOrWithAReason_IsSomethingElse) {
    for (int i = 0; i < 4; ++i) {
        EXPECT_EQ(ended(5s, 2s).after_sending, 0U);
        EXPECT_EQ(ended(1s, 10ms, 0x8b).after_sending, 0U) << "the broker shuts down";
    }
}

TEST_F(ClosesWhenDeniedTest, NothingSentOverThisConnection_IsSomethingElse) {
    ended(500ms, 10ms);
    ConnectionFailure failure{ConnectionFailure::Kind::kClosed, {}, 0, ""};
    closes_.ended(failure, 100ms, "uno1", now_ + 100ms);
    EXPECT_EQ(failure.after_sending, 0U);
}

TEST_F(ClosesWhenDeniedTest, AgainAndAgain_PausesGrowToAMinuteAndTheSizeIsSaid) {
    Duration last{};
    for (int i = 0; i < 20; ++i) {
        closes_.sent(now_, 5000);
        const auto failure = ended(1s, 10ms);
        if (i >= 2) {
            EXPECT_THAT(failure.text, HasSubstr("no message of 5000 bytes"));
        }
        EXPECT_GE(closes_.pause(1), last);
        last = closes_.pause(1);
        if (i < 2) {
            EXPECT_EQ(last, 0s);
        }
    }
    EXPECT_EQ(last, 1min);
    EXPECT_LT(closes_.pause(5), 10s) << "the others may take it";
    ended(11s, 10ms);
    EXPECT_EQ(closes_.pause(1), 0s);
}

}  // namespace
}  // namespace asip::mqtt
