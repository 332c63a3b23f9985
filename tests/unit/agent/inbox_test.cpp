// SPDX-License-Identifier: Apache-2.0
#include "agent/inbound/inbox.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

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
    const auto none = [](const Inbound&) { return false; };
    EXPECT_EQ(inbox.stop(none), 3u);
    EXPECT_EQ(inbox.stop(none), 0u) << "once";
    inbox.push(command("c"));
    EXPECT_TRUE(pop(inbox).stopped);
    EXPECT_TRUE(std::holds_alternative<LabelRequest>(inbox.pop())) << "labels are not stopped";
    EXPECT_TRUE(pop(inbox).stopped);
    EXPECT_FALSE(pop(inbox).stopped);
}

TEST(Inbox, RequestForALinkThatAStopCaught_SaysSo) {
    Inbox inbox;
    inbox.push(LinkRequest{});
    inbox.stop([](const Inbound&) { return false; });
    inbox.push(LinkRequest{});
    EXPECT_TRUE(std::get<LinkRequest>(inbox.pop()).stopped);
    EXPECT_FALSE(std::get<LinkRequest>(inbox.pop()).stopped);
}

TEST(Inbox, StopBehindWhatItsSenderSentLater_DoesNotCatchThat) {
    const auto sent = [](const std::string& payload, const std::string& by, int seconds) {
        Command made = command(payload);
        made.envelope.reply.by = by;
        made.arrival.told = Time{} + std::chrono::seconds(seconds);
        return made;
    };
    Stop stop;
    stop.envelope.reply.by = "ann";
    stop.arrival.told = Time{} + std::chrono::seconds(5);
    Inbox inbox;
    inbox.push(sent("before", "ann", 4));
    inbox.push(sent("behind", "ann", 6));
    inbox.push(sent("of another", "bob", 6));
    inbox.push(command("that tells nothing"));
    EXPECT_EQ(inbox.stop([&](const Inbound& other) { return sent_behind(stop, other); }), 3u);
    EXPECT_TRUE(pop(inbox).stopped);
    EXPECT_FALSE(pop(inbox).stopped);
    EXPECT_TRUE(pop(inbox).stopped);
    EXPECT_TRUE(pop(inbox).stopped);
}

// Steps of work in front of a stop, not milliseconds: of 10,000 commands that came before it, in reads of any
// size, with or without turns of the loop between them.
TEST(Inbox, StopBehindTenThousandCommands_IsReadAfterEightAreHandled) {
    for (const unsigned in_one_read : {9u, 64u, 1000u, 10'000u}) {
        Inbox inbox;
        unsigned handled = 0;
        for (unsigned read = 0; read < 10'000; read += in_one_read) {
            for (unsigned i = read; i < std::min(read + in_one_read, 10'000u); ++i)
                if (inbox.arrive(command("x"))) ++handled;
            if (inbox.asks_for_turn()) handled += static_cast<unsigned>(inbox.begin_turn());
        }
        EXPECT_EQ(handled, Inbox::kAtOnce) << in_one_read;
        EXPECT_EQ(inbox.stop([](const Inbound&) { return false; }), 10'000u - Inbox::kAtOnce);
    }
}

TEST(Inbox, FewerThanATurnTakes_WaitForNothing) {
    Inbox inbox;
    for (unsigned turn = 0; turn < 10; ++turn) {
        for (unsigned i = 0; i < Inbox::kAtOnce; ++i)
            EXPECT_TRUE(inbox.arrive(command("x")));
        EXPECT_TRUE(inbox.asks_for_turn());
        EXPECT_FALSE(inbox.asks_for_turn()) << "once";
        EXPECT_EQ(inbox.begin_turn(), 0u);
        EXPECT_FALSE(inbox.asks_for_turn()) << "nothing waits";
    }
}

TEST(Inbox, NothingArrivesAnyMore_EachTurnHandlesEight) {
    Inbox inbox;
    for (unsigned i = 0; i < 30; ++i)
        inbox.arrive(command("x"));
    std::vector<std::size_t> turns;
    while (inbox.asks_for_turn()) {
        turns.push_back(inbox.begin_turn());
        for (auto left = turns.back(); left > 0; --left)
            inbox.pop();
    }
    EXPECT_EQ(turns, (std::vector<std::size_t>{0, 8, 8, 6}));
}

TEST(Inbox, Full_EachThatArrivesHasTheOldestHandled) {
    Inbox inbox;
    for (unsigned i = 0; i < Inbox::kMaxMessages + 7; ++i)
        inbox.arrive(command(std::to_string(i)));
    const auto oldest = inbox.arrive(command("last"));
    ASSERT_TRUE(oldest);
    EXPECT_EQ(std::get<Command>(*oldest).payload, "8") << "behind the first eight, which did not wait";
    EXPECT_LT(inbox.size(), Inbox::kMaxMessages);
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
    constexpr std::size_t kArrays = 5000;
    for (std::size_t i = 0; i < kArrays; ++i)
        nested.envelope.object["write"].push_back(nlohmann::json::array());
    Inbox inbox;
    while (!inbox.full())
        inbox.push(nested);
    // 40 bytes each on machines of 64 bits.
    constexpr std::size_t kArray = sizeof(nlohmann::json) + sizeof(nlohmann::json::array_t);
    EXPECT_LE(inbox.size(), Inbox::kMaxBytes / (kArrays * kArray) + 1);
}

}  // namespace
}  // namespace asip::agent
