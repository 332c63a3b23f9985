// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/subscriptions.hpp"

#include <gmock/gmock.h>

namespace asip::mqtt {
namespace {

using namespace std::chrono_literals;
using testing::IsEmpty;

std::vector<std::string> filters(const std::vector<Subscriptions::Due>& all) {
    std::vector<std::string> result;
    for (const auto& due : all)
        result.push_back(due.filter);
    return result;
}

class SubscriptionsTest : public testing::Test {
  protected:
    std::vector<Subscriptions::Due> send_due() {
        auto all = subscriptions.take_due(now);
        for (const auto& due : all)
            subscriptions.sent(++last_id, due.filter, now);
        return all;
    }
    std::optional<Subscriptions::Refusal> answer(bool granted) {
        return subscriptions.answered(last_id, granted, now, random);
    }

    Subscriptions subscriptions;
    Time now = Time{} + 1h;
    int last_id = 0;
    Random random = [] { return ~std::uint64_t{0}; };
};

TEST_F(SubscriptionsTest, Refused_IsDueAgainAfterAGrowingPause) {
    subscriptions.add("a", {});
    Duration last{};
    send_due();
    for (int i = 0; i < 8; ++i) {
        const auto refusal = answer(false);
        ASSERT_TRUE(refusal);
        EXPECT_EQ(refusal->first, i == 0);
        EXPECT_FALSE(refusal->give_up) << "it is not required";
        EXPECT_FALSE(subscriptions.usable());
        const auto begin = now;
        while (send_due().empty() && now - begin < 1min)
            now += 100ms;
        EXPECT_GE(now - begin, last);
        EXPECT_LE(now - begin, 30s);
        last = now - begin;
    }
    EXPECT_GE(last, 15s);
    answer(true);
    EXPECT_TRUE(subscriptions.usable());
}

TEST_F(SubscriptionsTest, Refused_IsSaidUntilTheNextConnection) {
    subscriptions.add("a", {.qos = 1, .no_local = true});
    EXPECT_FALSE(send_due().at(0).was_refused);
    answer(false);
    now += 1min;
    const auto again = send_due();
    EXPECT_TRUE(again.at(0).was_refused);
    EXPECT_TRUE(again.at(0).options.no_local);
    subscriptions.restart();
    EXPECT_FALSE(send_due().at(0).was_refused);
}

TEST_F(SubscriptionsTest, CouldNotBeSent_IsDueAgain) {
    subscriptions.add("a", {});
    EXPECT_THAT(filters(subscriptions.take_due(now)), testing::ElementsAre("a"));
    EXPECT_THAT(subscriptions.take_due(now), IsEmpty());
    subscriptions.not_sent("a");
    EXPECT_THAT(filters(subscriptions.take_due(now)), testing::ElementsAre("a"));
    subscriptions.remove("a");
    subscriptions.not_sent("a");
    EXPECT_THAT(subscriptions.take_due(now), IsEmpty());
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
    EXPECT_THAT(filters(send_due()), testing::ElementsAre("a"));
    answer(true);
    EXPECT_TRUE(subscriptions.usable());
    subscriptions.remove("b");
    EXPECT_TRUE(subscriptions.usable());
    subscriptions.restart();
    EXPECT_FALSE(subscriptions.usable());
    EXPECT_THAT(filters(send_due()), testing::ElementsAre("a"));
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
