// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/failure.hpp"

#include <gtest/gtest.h>

namespace asip::mqtt {
namespace {

TEST(Outage, SameFailureAgain_IsNoNewsUntilItIsOver) {
    const ConnectionFailure refused{ConnectionFailure::Kind::kUnreachable, {"a", 1883, false}, 0, "refused"};
    const ConnectionFailure silent{ConnectionFailure::Kind::kNoAnswer, {"a", 1883, false}, 0, "silent"};
    const ConnectionFailure other{ConnectionFailure::Kind::kUnreachable, {"b", 1883, false}, 0, "refused"};
    Outage outage;
    EXPECT_TRUE(outage.is_news(refused));
    EXPECT_TRUE(outage.is_news(other));
    EXPECT_TRUE(outage.is_news(silent));
    for (int i = 0; i < 1000; ++i)
        EXPECT_FALSE(outage.is_news(i % 2 == 0 ? refused : other));
    outage.over();
    EXPECT_TRUE(outage.is_news(refused));
}

}  // namespace
}  // namespace asip::mqtt
