// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/turn.hpp"

#include <gtest/gtest.h>

namespace asip::gateway::exports {
namespace {

using namespace std::chrono_literals;

Turn lease(const std::string& name) {
    return Turn({name, 0, "host", {"homeassistant"}}, [] { return std::uint64_t{0}; });
}

constexpr Time kStart = Time{} + 1h;

TEST(Turn, NobodyHoldsIt_IsClaimedOnceWhatIsRetainedHasCome) {
    auto a = lease("a");
    EXPECT_FALSE(a.may_claim(kStart)) << "the bus is not heard";
    a.subscribed(kStart);
    EXPECT_FALSE(a.may_claim(kStart + 999ms));
    EXPECT_TRUE(a.may_claim(kStart + 1s));
}

TEST(Turn, HolderThatLives_IsLeftAlone_AndFollowedWhenItFallsSilent) {
    auto a = lease("a"), b = lease("b");
    b.subscribed(kStart);
    a.subscribed(kStart);
    const auto claim = b.claim(kStart + 1s);
    a.said(claim, false, kStart + 1s);
    EXPECT_FALSE(a.may_claim(kStart + 8900ms));
    EXPECT_TRUE(a.may_claim(kStart + 9s));
    EXPECT_FALSE(b.renewal(kStart + 3900ms));
    ASSERT_TRUE(b.renewal(kStart + 4s));
    a.said(*b.renewal(kStart + 8s), false, kStart + 8s);
    EXPECT_FALSE(a.may_claim(kStart + 15s));
}

TEST(Turn, BrokerSaysThatItsHolderIsGone_IsClaimedAtOnce) {
    auto a = lease("a"), b = lease("b");
    a.subscribed(kStart);
    b.subscribed(kStart);
    a.said(b.claim(kStart + 2s), false, kStart + 2s);
    a.state("online", kStart + 2s);
    EXPECT_FALSE(a.may_claim(kStart + 3s));
    a.state("offline", kStart + 3s);
    EXPECT_TRUE(a.may_claim(kStart + 3s));
}

TEST(Turn, RetainedOneOfAGatewayThatIsGone_DoesNotHold) {
    auto a = lease("a"), b = lease("b");
    const auto claim = b.claim(kStart);
    a.subscribed(kStart + 1h);
    a.state("offline", kStart + 1h);
    a.said(claim, true, kStart + 1h);
    EXPECT_TRUE(a.may_claim(kStart + 1h + 1s));
    ASSERT_TRUE(a.holder());
    EXPECT_EQ(a.holder()->host, "host");
}

TEST(Turn, OfTwoThatClaim_TheLaterTermCountsThenTheSmallerName) {
    auto a = lease("a"), b = lease("b");
    const auto by_a = a.claim(kStart), by_b = b.claim(kStart);
    EXPECT_FALSE(a.said(by_b, false, kStart));
    EXPECT_TRUE(a.active());
    EXPECT_TRUE(a.renewal(kStart)) << "the other must hear of it";
    EXPECT_TRUE(b.said(by_a, false, kStart));
    EXPECT_FALSE(b.active());
    const auto later = b.claim(kStart + 20s);
    EXPECT_TRUE(a.said(later, false, kStart + 20s)) << "it was asleep meanwhile";
    EXPECT_FALSE(a.active());
}

TEST(Turn, AnyText_ChangesNothing) {
    auto a = lease("a");
    a.claim(kStart);
    for (const auto* text :
         {"", "{", "[]", R"({"gateway":"z"})", R"({"gateway":7,"term":9})", R"({"gateway":"z","term":-1})"})
        EXPECT_FALSE(a.said(text, false, kStart)) << text;
    EXPECT_TRUE(a.active());
}

TEST(Turn, EmptiedLease_IsSaidAgainAtOnce) {
    auto a = lease("a");
    a.claim(kStart);
    EXPECT_FALSE(a.renewal(kStart + 1s));
    a.said("", false, kStart + 1s);
    EXPECT_TRUE(a.renewal(kStart + 1s));
    EXPECT_FALSE(a.renewal(kStart + 2s));

    auto b = lease("b");
    b.subscribed(kStart);
    const auto claim = a.claim(kStart + 2s);
    b.said(claim, false, kStart + 2s);
    b.said("", false, kStart + 3s);
    EXPECT_FALSE(b.may_claim(kStart + 3s)) << "its holder may live";
    EXPECT_TRUE(b.may_claim(kStart + 4s));
    EXPECT_NE(b.claim(kStart + 4s).find("homeassistant"), std::string::npos) << "what is there is cleared";
    b.release();
    b.said(claim, false, kStart + 5s);
    EXPECT_FALSE(b.may_claim(kStart + 5s)) << "it lives";
}

TEST(Turn, PlaceOfDocuments_IsThatOfTheOneBeforeUntilItIsCleared) {
    auto a = lease("a");
    Turn old({"old", 0, "host", {"elsewhere"}}, [] { return std::uint64_t{0}; });
    a.said(old.claim(kStart), true, kStart);
    EXPECT_NE(a.claim(kStart + 9s).find("elsewhere"), std::string::npos);
    a.set_place("homeassistant");
    EXPECT_NE(a.renewal(kStart + 9s)->find("homeassistant"), std::string::npos);
}

}  // namespace
}  // namespace asip::gateway::exports
