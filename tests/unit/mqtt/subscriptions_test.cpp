// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/subscriptions.hpp"

#include <gmock/gmock.h>

namespace asip::mqtt {
namespace {

using namespace std::chrono_literals;
using testing::IsEmpty;

std::vector<std::string> filters(const std::vector<Subscriptions::Sending>& sendings) {
    std::vector<std::string> result;
    for (const auto& [filter, options] : sendings)
        result.push_back(filter);
    return result;
}

class SubscriptionsTest : public testing::Test {
  protected:
    void send_due() {
        for (const auto& [filter, options] : subscriptions.due(now))
            subscriptions.sent(++last_id, filter, now);
    }
    std::optional<Subscriptions::Refusal> answer(bool granted) {
        return subscriptions.answered(last_id, granted, now, random);
    }

    Subscriptions subscriptions;
    Time now = Time{} + 1h;
    int last_id = 0;
    Random random = [] { return ~std::uint64_t{0}; };
};

TEST_F(SubscriptionsTest, Granted_IsCompleteAndNotDueAgain) {
    subscriptions.add("a", {});
    EXPECT_FALSE(subscriptions.usable());
    send_due();
    EXPECT_THAT(subscriptions.due(now), IsEmpty());
    EXPECT_EQ(answer(true), std::nullopt);
    EXPECT_TRUE(subscriptions.usable());
    now += 1h;
    EXPECT_THAT(subscriptions.due(now), IsEmpty());
}

TEST_F(SubscriptionsTest, Refused_IsDueAgainAfterAGrowingPause) {
    subscriptions.add("a", {});
    Duration last{};
    for (int i = 0; i < 8; ++i) {
        send_due();
        const auto refusal = answer(false);
        ASSERT_TRUE(refusal);
        EXPECT_EQ(refusal->first, i == 0);
        EXPECT_FALSE(refusal->give_up) << "it is not required";
        EXPECT_FALSE(subscriptions.usable());
        EXPECT_THAT(subscriptions.due(now), IsEmpty());
        const auto begin = now;
        while (subscriptions.due(now).empty() && now - begin < 1min)
            now += 100ms;
        EXPECT_GE(now - begin, last);
        EXPECT_LE(now - begin, 30s);
        last = now - begin;
    }
    EXPECT_GE(last, 15s);
    send_due();
    answer(true);
    EXPECT_TRUE(subscriptions.usable());
}

TEST_F(SubscriptionsTest, RefusedWithQos1_IsAskedForWithQos0UntilTheNextConnection) {
    subscriptions.add("a", {.qos = 1, .no_local = true});
    EXPECT_EQ(subscriptions.due(now).at(0).second.qos, 1);
    send_due();
    answer(false);
    now += 1min;
    EXPECT_EQ(subscriptions.due(now).at(0).second.qos, 0);
    EXPECT_TRUE(subscriptions.due(now).at(0).second.no_local);
    send_due();
    answer(true);
    EXPECT_TRUE(subscriptions.usable());
    subscriptions.restart();
    EXPECT_EQ(subscriptions.due(now).at(0).second.qos, 1);
}

TEST_F(SubscriptionsTest, RequiredAndRefusedThreeTimes_GivesTheBrokerUp) {
    subscriptions.add("a", {.required = true});
    for (int i = 1; i <= 3; ++i) {
        send_due();
        EXPECT_EQ(answer(false)->give_up, i == 3);
        now += 1min;
    }
}

TEST_F(SubscriptionsTest, Required_AreAskedForBeforeTheOthersAndMakeItUsable) {
    subscriptions.add("a", {});
    subscriptions.add("b", {.required = true});
    subscriptions.add("c", {.required = true});
    for (int connection = 0; connection < 2; ++connection) {
        EXPECT_THAT(filters(subscriptions.due(now)), testing::ElementsAre("b", "c"));
        send_due();
        EXPECT_THAT(subscriptions.due(now), IsEmpty());
        answer(true);
        EXPECT_FALSE(subscriptions.usable());
        EXPECT_TRUE(subscriptions.holds_back(now));
        subscriptions.answered(last_id - 1, true, now, random);
        EXPECT_TRUE(subscriptions.usable());
        EXPECT_FALSE(subscriptions.holds_back(now));
        EXPECT_TRUE(subscriptions.unanswered());
        EXPECT_THAT(filters(subscriptions.due(now)), testing::ElementsAre("a"));
        send_due();
        EXPECT_FALSE(subscriptions.all_granted());
        answer(connection == 1);
        EXPECT_EQ(subscriptions.all_granted(), connection == 1);
        EXPECT_FALSE(subscriptions.unanswered());
        EXPECT_TRUE(subscriptions.usable());
        subscriptions.restart();
    }
}

TEST_F(SubscriptionsTest, RequiredAndRefused_DoesNotHoldTheOthersBack) {
    subscriptions.add("a", {});
    subscriptions.add("b", {.required = true});
    send_due();
    answer(false);
    EXPECT_FALSE(subscriptions.usable());
    EXPECT_THAT(filters(subscriptions.due(now)), testing::ElementsAre("a"));
}

TEST_F(SubscriptionsTest, RequiredRemovedUnanswered_DoesNotHoldTheOthersBack) {
    subscriptions.add("a", {});
    subscriptions.add("b", {.required = true});
    send_due();
    subscriptions.remove("b");
    EXPECT_FALSE(subscriptions.holds_back(now));
    EXPECT_THAT(filters(subscriptions.due(now)), testing::ElementsAre("a"));
    subscriptions.add("b", {});
    subscriptions.add("b", {.required = true});
    EXPECT_THAT(filters(subscriptions.due(now)), testing::ElementsAre("b"));
}

TEST_F(SubscriptionsTest, RequiredGrantedByABusyBroker_TheOthersWaitAsLongAgain) {
    subscriptions.add("a", {});
    subscriptions.add("b", {.required = true});
    subscriptions.add("c", {.required = true});
    const auto grant_after = [&](Duration took, bool defers = true) {
        subscriptions.restart(defers);
        send_due();
        now += took / 2;
        answer(true);
        EXPECT_THAT(subscriptions.due(now), IsEmpty());
        now += took - took / 2;
        subscriptions.answered(last_id - 1, true, now, random);
        EXPECT_TRUE(subscriptions.usable());
    };
    const auto waits = [&](Duration wait) {
        now += wait - 1ms;
        EXPECT_TRUE(subscriptions.holds_back(now));
        EXPECT_THAT(subscriptions.due(now), IsEmpty());
        now += 1ms;
        EXPECT_FALSE(subscriptions.holds_back(now));
        EXPECT_THAT(filters(subscriptions.due(now)), testing::ElementsAre("a"));
    };
    grant_after(2s);
    waits(2s);
    grant_after(1min);
    waits(Subscriptions::kMostDeference);
    grant_after(2s);
    grant_after(Subscriptions::kBusy - 1ms);
    EXPECT_THAT(filters(subscriptions.due(now)), testing::ElementsAre("a"))
        << "nor is the wait of an earlier connection kept";
    grant_after(2s, false);
    EXPECT_THAT(filters(subscriptions.due(now)), testing::ElementsAre("a"));
}

TEST_F(SubscriptionsTest, NewConnection_MakesEverythingDueAndForgetsOldAnswers) {
    subscriptions.add("a", {});
    subscriptions.add("b", {});
    send_due();
    const int old = last_id;
    subscriptions.restart();
    EXPECT_EQ(subscriptions.answered(old, true, now, random), std::nullopt);
    EXPECT_FALSE(subscriptions.usable());
    EXPECT_THAT(filters(subscriptions.due(now)), testing::ElementsAre("a", "b"));
    EXPECT_EQ(subscriptions.waiting_since(), std::nullopt);
}

TEST_F(SubscriptionsTest, Removed_IsNeitherMissedNorRefused) {
    subscriptions.add("a", {});
    send_due();
    subscriptions.remove("a");
    EXPECT_TRUE(subscriptions.usable());
    EXPECT_EQ(answer(false), std::nullopt);
}

TEST_F(SubscriptionsTest, GrantedOneRemovedOrAskedForAnew_IsCountedOnce) {
    subscriptions.add("a", {});
    send_due();
    answer(true);
    subscriptions.add("b", {});
    send_due();
    answer(true);
    EXPECT_TRUE(subscriptions.usable());
    subscriptions.add("a", {.qos = 1});
    EXPECT_FALSE(subscriptions.usable());
    EXPECT_THAT(filters(subscriptions.due(now)), testing::ElementsAre("a"));
    send_due();
    answer(true);
    EXPECT_TRUE(subscriptions.usable());
    subscriptions.remove("b");
    EXPECT_TRUE(subscriptions.usable());
    subscriptions.restart();
    EXPECT_FALSE(subscriptions.usable());
    EXPECT_THAT(filters(subscriptions.due(now)), testing::ElementsAre("a"));
}

TEST_F(SubscriptionsTest, WithoutAnAnswer_SaysSinceWhen) {
    subscriptions.add("a", {});
    const auto first = now;
    send_due();
    now += 5s;
    subscriptions.add("b", {});
    send_due();
    EXPECT_EQ(subscriptions.waiting_since(), first);
}

}  // namespace
}  // namespace asip::mqtt
