// SPDX-License-Identifier: Apache-2.0
#include "agent/command/inbox.hpp"

#include <gtest/gtest.h>

namespace asip::agent {
namespace {

mqtt::Message command(const std::string& payload) {
    mqtt::Message message;
    message.payload = payload;
    return message;
}

TEST(Inbox, Entries_ComeOutInTheirOrderWithTheTimeOfTheirArrival) {
    Inbox inbox;
    const Time begin{};
    inbox.push(command("a"), begin);
    inbox.push(command("b"), begin + std::chrono::seconds(1));
    EXPECT_EQ(inbox.pop().message.payload, "a");
    EXPECT_EQ(inbox.pop().arrived, begin + std::chrono::seconds(1));
    EXPECT_TRUE(inbox.empty());
}

TEST(Inbox, Stop_CatchesWhatCameBeforeItAndNothingElse) {
    Inbox inbox;
    inbox.push(command("a"), {});
    inbox.push(command("b"), {});
    EXPECT_EQ(inbox.waiting(), 2u);
    inbox.stop();
    EXPECT_EQ(inbox.waiting(), 0u);
    inbox.push(command("c"), {});
    EXPECT_EQ(inbox.waiting(), 1u);
    EXPECT_TRUE(inbox.pop().stopped);
    EXPECT_TRUE(inbox.pop().stopped);
    EXPECT_FALSE(inbox.pop().stopped);
}

TEST(Inbox, ManyOrLargeOnes_AreTooMany) {
    Inbox many;
    while (!many.full())
        many.push(command("x"), {});
    EXPECT_EQ(many.size(), Inbox::kMaxMessages);
    many.pop();
    EXPECT_FALSE(many.full());
    for (auto fill : {&mqtt::Message::topic, &mqtt::Message::response_topic, &mqtt::Message::correlation}) {
        Inbox inbox;
        while (!inbox.full()) {
            auto message = command("x");
            message.*fill = std::string(65535, 'x');
            inbox.push(message, {});
        }
        EXPECT_EQ(inbox.size(), 128u) << "each part of a message counts";
        while (!inbox.empty())
            inbox.pop();
        EXPECT_FALSE(inbox.full());
    }
    Inbox large;
    while (!large.full())
        large.push(command(std::string(1 << 20, 'x')), {});
    EXPECT_EQ(large.size(), 8u);
}

}  // namespace
}  // namespace asip::agent
