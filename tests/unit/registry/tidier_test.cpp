// SPDX-License-Identifier: Apache-2.0
#include "registry/tidier.hpp"

#include <gmock/gmock.h>

#include "messages.hpp"

namespace asip::registry {
namespace tidier_test {

using testing::ElementsAre;
using testing::IsEmpty;

class TidierTest : public testing::Test {
  protected:
    static Port record(TidierTest& test) {
        Port port;
        port.publish = [&test](mqtt::Message message) {
            EXPECT_TRUE(message.retain);
            EXPECT_EQ(message.payload, "");
            test.cleared.push_back(message.topic);
        };
        port.subscribe = [&test](std::string filter, bool) { test.subscribed.push_back(filter); };
        port.unsubscribe = [&test](const std::string& filter) { test.unsubscribed.push_back(filter); };
        return port;
    }

    bus::Topics topics;
    std::vector<std::string> cleared, subscribed, unsubscribed;
    bool alive = false;
    Tidier tidier{topics, record(*this), [this](const std::string&) { return alive; }};
};

TEST_F(TidierTest, Ghost_IsClearedAfterAMomentUnlessItCameBack) {
    tidier.ghost("uno1", at(0s));
    tidier.tick(at(1s));
    EXPECT_THAT(cleared, IsEmpty());
    tidier.tick(at(2s));
    EXPECT_THAT(cleared, ElementsAre("asip/servicebus/uno1/$description"));
    tidier.ghost("uno2", at(2s));
    alive = true;
    tidier.tick(at(9s));
    EXPECT_EQ(cleared.size(), 1u);
}

TEST_F(TidierTest, ForgottenBoard_IsSweptForWhatElseIsRetained) {
    tidier.forgotten("uno1");
    EXPECT_EQ(cleared.size(), 4u);
    tidier.retained("asip/uno1/in", "uno1");
    EXPECT_EQ(cleared.size(), 4u) << "not asked for yet";
    tidier.tick(at(0s));
    EXPECT_THAT(subscribed, ElementsAre("asip/uno1/#"));
    tidier.retained("asip/uno1/in", "uno1");
    tidier.retained("asip/uno2/in", "uno2");
    tidier.retained("asip/uno1/io/out", "uno1");
    EXPECT_EQ(cleared.back(), "asip/uno1/in");
    tidier.published("asip/uno1/in");
    EXPECT_EQ(cleared.back(), "asip/uno1/io/out");
    EXPECT_EQ(cleared.size(), 6u);
    tidier.tick(at(3s));
    EXPECT_THAT(unsubscribed, ElementsAre("asip/uno1/#"));
}

TEST_F(TidierTest, Denied_IsReportedOnceAndNothingIsTriedAgain) {
    tidier.forgotten("uno1");
    tidier.tick(at(0s));
    tidier.retained("asip/uno1/in", "uno1");
    tidier.retained("asip/uno1/io/out", "uno1");
    EXPECT_TRUE(tidier.denied("asip/uno1/in", at(1s)));
    EXPECT_THAT(unsubscribed, ElementsAre("asip/uno1/#"));
    const auto before = cleared.size();
    // The connection was lost over it: the broker delivers again what it retains.
    tidier.retained("asip/uno1/in", "uno1");
    tidier.forgotten("uno2");
    tidier.tick(at(2s));
    EXPECT_EQ(subscribed.size(), 1u) << "no sweep of another board either";
    EXPECT_EQ(cleared.size(), before + 4) << "its topics on the service bus only";
    EXPECT_FALSE(tidier.denied("asip/servicebus/uno2/$state", at(3s))) << "reported already";
    tidier.forgotten("uno2");
    EXPECT_EQ(cleared.size(), before + 7) << "all but the one that was denied";
}

TEST_F(TidierTest, DeniedAnHourAgo_IsTriedAgain) {
    tidier.forgotten("uno1");
    EXPECT_TRUE(tidier.denied("asip/servicebus/uno1/$state", at(0s)));
    tidier.tick(at(1h));
    cleared.clear();
    tidier.forgotten("uno1");
    EXPECT_EQ(cleared.size(), 4u);
    EXPECT_TRUE(tidier.denied("asip/servicebus/uno1/$state", at(1h + 1s)));
}

TEST_F(TidierTest, DeniedMessageOfSomebodyElse_ChangesNothing) {
    EXPECT_FALSE(tidier.denied("asip/reply/x", at(0s)));
    tidier.forgotten("uno1");
    tidier.tick(at(1s));
    EXPECT_THAT(subscribed, ElementsAre("asip/uno1/#"));
}

TEST_F(TidierTest, NeverAcknowledged_TheNextTopicIsTriedAfterAWhile) {
    tidier.forgotten("uno1");
    tidier.tick(at(0s));
    tidier.retained("asip/uno1/in", "uno1");
    tidier.retained("asip/uno1/io/out", "uno1");
    tidier.tick(at(1s));
    tidier.tick(at(1s + Tidier::kClearTime));
    EXPECT_EQ(cleared.back(), "asip/uno1/io/out");
}

}  // namespace tidier_test
}  // namespace asip::registry
