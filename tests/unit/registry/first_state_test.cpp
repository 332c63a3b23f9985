// SPDX-License-Identifier: Apache-2.0
#include "registry/first_state.hpp"

#include <gmock/gmock.h>

#include <vector>

#include "messages.hpp"

namespace asip::registry {
namespace first_state_test {

using testing::ElementsAre;

class FirstStateTest : public testing::Test {
  protected:
    Time now = at(0s);
    std::vector<std::string> sent;
    int complete = 0;
    FirstState first{
        bus::Topics(), "marks",
        [this](const mqtt::Message& message) {
            sent.push_back(message.topic + ' ' + message.payload + " " + std::to_string(message.qos));
        },
        [this] { ++complete; }};
};

TEST_F(FirstStateTest, MarkComesBack_StateIsWholeOnce) {
    first.begin("aa", now);
    EXPECT_THAT(sent, ElementsAre("marks aa 1", "asip/servicebus/$probe  0"));
    EXPECT_FALSE(first.mark("bb")) << "a query";
    EXPECT_TRUE(first.active());
    EXPECT_TRUE(first.mark("aa"));
    EXPECT_FALSE(first.mark("aa"));
    EXPECT_FALSE(first.active());
    EXPECT_EQ(complete, 1);
}

TEST_F(FirstStateTest, MarkIsLost_StateIsWholeOnceNothingComesAnyMore) {
    first.begin("aa", now);
    for (int i = 0; i < 100; ++i) {
        first.retained_came(now += 1s);
        first.tick(now);
    }
    first.tick(now += FirstState::kRetainedTime - 1ms);
    EXPECT_EQ(complete, 0);
    first.tick(now += 1ms);
    EXPECT_EQ(complete, 1);
}

TEST_F(FirstStateTest, ConnectionLost_MarkAndTimeOfItCountForNothing) {
    first.begin("aa", now);
    first.end();
    first.begin("bb", now);
    EXPECT_FALSE(first.mark("aa"));
    first.end();
    first.tick(now += FirstState::kRetainedTime);
    EXPECT_FALSE(first.mark(""));
    EXPECT_EQ(complete, 0);
}

}  // namespace first_state_test
}  // namespace asip::registry
