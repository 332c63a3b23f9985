// SPDX-License-Identifier: Apache-2.0
#include "agent/inbound/inbox.hpp"

#include <gtest/gtest.h>

namespace asip::agent {
namespace {

Command command(const std::string& payload, Time received = {}) {
    Command command;
    command.payload = payload;
    command.arrival.received = received;
    return command;
}

Command pop(Inbox& inbox) {
    return std::get<Command>(inbox.pop());
}

TEST(Inbox, Messages_ComeOutInTheirOrderWithTheTimeOfTheirArrival) {
    Inbox inbox;
    const Time begin{};
    inbox.push(command("a", begin));
    inbox.push(command("b", begin + std::chrono::seconds(1)));
    EXPECT_EQ(pop(inbox).payload, "a");
    EXPECT_EQ(pop(inbox).arrival.received, begin + std::chrono::seconds(1));
    EXPECT_TRUE(inbox.empty());
}

TEST(Inbox, Stop_CatchesWhatCameBeforeItAndNothingElse) {
    Inbox inbox;
    inbox.push(command("a"));
    inbox.push(LabelRequest{});
    inbox.push(command("b"));
    EXPECT_EQ(inbox.waiting(), 3u);
    inbox.stop();
    EXPECT_EQ(inbox.waiting(), 0u);
    inbox.push(command("c"));
    EXPECT_EQ(inbox.waiting(), 1u);
    EXPECT_TRUE(pop(inbox).stopped);
    EXPECT_TRUE(std::holds_alternative<LabelRequest>(inbox.pop())) << "labels are not stopped";
    EXPECT_TRUE(pop(inbox).stopped);
    EXPECT_FALSE(pop(inbox).stopped);
}

TEST(Inbox, ManyOrLargeOnes_AreTooMany) {
    Inbox many;
    while (!many.full())
        many.push(command("x"));
    EXPECT_EQ(many.size(), Inbox::kMaxMessages);
    many.pop();
    EXPECT_FALSE(many.full());
    const auto fill = [](auto&& set) {
        Command part = command("x");
        set(part);
        Inbox inbox;
        while (!inbox.full())
            inbox.push(part);
        EXPECT_LE(inbox.size(), Inbox::kMaxBytes / 65535 + 1) << "each part of a message counts";
        while (!inbox.empty())
            inbox.pop();
        EXPECT_FALSE(inbox.full());
    };
    const std::string long_text(65535, 'x');
    fill([&](Command& part) { part.topic = long_text; });
    fill([&](Command& part) { part.envelope.text = long_text; });
    fill([&](Command& part) { part.envelope.reply.topic = long_text; });
    fill([&](Command& part) { part.envelope.reply.correlation = long_text; });
    Inbox large;
    while (!large.full())
        large.push(command(std::string(1 << 20, 'x')));
    EXPECT_EQ(large.size(), Inbox::kMaxBytes >> 20);
    while (!large.empty())
        large.pop();
    EXPECT_FALSE(large.full());
}

TEST(Inbox, ParsedJson_CountsWithItsMemory) {
    Command nested = command("");
    nested.envelope.object["write"] = nlohmann::json::array();
    for (int i = 0; i < 5000; ++i)
        nested.envelope.object["write"].push_back(nlohmann::json::array());
    Inbox inbox;
    while (!inbox.full())
        inbox.push(nested);
    EXPECT_LT(inbox.size(), 100u) << "each has 5000 arrays of 40 bytes and more";
}

}  // namespace
}  // namespace asip::agent
