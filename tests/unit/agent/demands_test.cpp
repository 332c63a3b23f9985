// SPDX-License-Identifier: Apache-2.0
#include "agent/reports/demands.hpp"

#include <gtest/gtest.h>

namespace asip::agent {
namespace {

using namespace std::chrono_literals;

bus::Demand demand(double hz, std::chrono::seconds lease = 10s, const std::string& service = "distance") {
    return {{{service, hz}}, lease};
}

TEST(Demands, FastestCounts_UntilItsLeaseAndAMomentMore) {
    Demands demands;
    const Time now{1000s};
    demands.take("ann/1", demand(2, 60s), now);
    demands.take("bob/1", demand(20, 10s), now);
    EXPECT_EQ(demands.hz("distance", 'D'), 20);
    EXPECT_EQ(demands.hz("io", 'I'), 0);
    EXPECT_EQ(demands.next_deadline(), now + 10s + Demands::kLinger);
    EXPECT_FALSE(demands.expire(now + 10s));
    EXPECT_TRUE(demands.expire(now + 10s + Demands::kLinger));
    EXPECT_EQ(demands.hz("distance", 'D'), 2);
}

TEST(Demands, OneThatLeaves_CountsAMomentMore_AndComesBackAtOnce) {
    Demands demands;
    const Time now{1000s};
    demands.take("ann/1", demand(2), now);
    demands.take("ann/1", {{}, 10s}, now);
    EXPECT_EQ(demands.hz("distance", 'D'), 2);
    EXPECT_TRUE(demands.expire(now + Demands::kLinger));
    EXPECT_EQ(demands.size(), 0u);
    EXPECT_EQ(demands.next_deadline(), std::nullopt);
    demands.take("ann/1", {{}, 10s}, now);
    EXPECT_EQ(demands.size(), 0u) << "nobody knew it";
}

TEST(Demands, PatternOrLetter_NamesAService) {
    Demands demands;
    demands.take("ann/1", demand(2, 10s, "dist*"), {});
    demands.take("ann/2", demand(3, 10s, "I"), {});
    EXPECT_EQ(demands.hz("distance", 'D'), 2);
    EXPECT_EQ(demands.hz("io", 'I'), 3);
}

TEST(Demands, TenThousandOfOneUser_TakeNoPlaceFromOthers) {
    Demands demands;
    std::size_t refused = 0;
    for (int i = 0; i < 10'000; ++i)
        refused += demands.take("mallory/" + std::to_string(i), demand(1), Time{}) ? 0u : 1u;
    EXPECT_EQ(demands.size(), Demands::kMax);
    EXPECT_EQ(refused, 10'000 - Demands::kMax);
    for (int i = 0; i < 100; ++i)
        EXPECT_TRUE(demands.take("ann/" + std::to_string(i), demand(5), Time{}));
    EXPECT_EQ(demands.size(), Demands::kMax);
    EXPECT_EQ(demands.hz("distance", 'D'), 5);
    EXPECT_TRUE(demands.take("ann/1", demand(6), Time{})) << "one that is known is renewed";
    EXPECT_FALSE(demands.take("mallory/x", demand(7), Time{}));
}

}  // namespace
}  // namespace asip::agent
