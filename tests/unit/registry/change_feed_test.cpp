// SPDX-License-Identifier: Apache-2.0
#include "registry/change_feed.hpp"

#include <gmock/gmock.h>

#include "messages.hpp"
#include "tests/support/catalogue_view.hpp"

namespace asip::registry {
namespace change_feed_test {

using Kind = Event::Kind;
using model::BoardState;

constexpr std::size_t kBehind = ChangeFeed::kMaxQueued + 1;

struct ChangeFeedTest : testing::Test {
    ChangeFeedTest() {
        feed.begin("e-1");
        feed.complete();
        EXPECT_TRUE(feed.reset(now, 0));
    }
    void apply(const OwnedMessage& message) {
        for (const auto& event : catalogue.apply(message.view(), now.time).events)
            if (event.is_change()) feed.change(event);
    }
    void come_and_go(const std::string& board, std::uint64_t seq) {
        apply(description(board, {.seq = seq}));
        apply(state(board, "lost"));
    }
    std::vector<bus::ChangeEvent> drain(std::size_t queued = 0) {
        std::vector<bus::ChangeEvent> events;
        while (auto event = feed.next(catalogue, now, queued))
            events.push_back(std::move(*event));
        return events;
    }

    Instant now = instant(at(0s));
    Catalogue catalogue;
    ChangeFeed feed{"r1"};
};

TEST_F(ChangeFeedTest, BrokerKeepsUp_EachChangeIsAnEventWithTheNextNumber) {
    apply(description("uno1"));
    const auto added = drain(ChangeFeed::kMaxQueued);
    ASSERT_EQ(added.size(), 1u);
    EXPECT_EQ(added[0].kind, bus::ChangeEvent::Kind::kAdded);
    EXPECT_EQ(added[0].seq, 1u);
    apply(state("uno1", "lost"));
    const auto lost = drain();
    ASSERT_EQ(lost.size(), 1u);
    EXPECT_EQ(lost[0].seq, 2u);
    EXPECT_EQ(lost[0].was, "online");
    EXPECT_EQ(lost[0].board.state, "lost");
    EXPECT_EQ(feed.seq(), 2u);
}

TEST_F(ChangeFeedTest, BrokerBehind_ChangesOfABoardBecomeOneAndNumbersHaveNoGap) {
    for (int i = 0; i < 3; ++i)
        for (std::uint64_t round = 1; round <= 5; ++round)
            come_and_go("uno" + std::to_string(i), round);
    EXPECT_TRUE(drain(kBehind).empty());
    EXPECT_EQ(feed.seq(), 0u);
    EXPECT_EQ(feed.waiting(), 3u);
    const auto events = drain();
    ASSERT_EQ(events.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(events[i].seq, i + 1);
        EXPECT_EQ(events[i].kind, bus::ChangeEvent::Kind::kAdded);
        EXPECT_EQ(events[i].board.state, "lost");
    }
    EXPECT_FALSE(feed.overrun());
}

TEST_F(ChangeFeedTest, MoreBoardsThanMayWait_OneResetOnceTheBrokerHasCaughtUp) {
    Event change{Kind::kState, {}};
    for (std::size_t i = 0; i <= ChangeFeed::kMaxWaiting; ++i) {
        change.board = std::to_string(i);
        feed.change(change);
    }
    EXPECT_TRUE(feed.overrun());
    EXPECT_EQ(feed.waiting(), 0u);
    EXPECT_TRUE(drain().empty()) << "a gap must not be hidden";
    EXPECT_FALSE(feed.reset(now, ChangeFeed::kMaxQueued / 2));
    const auto reset = feed.reset(now, 0);
    ASSERT_TRUE(reset);
    EXPECT_EQ(reset->seq, ChangeFeed::kMaxWaiting + 1);
    apply(description("uno1"));
    const auto next = drain();
    ASSERT_EQ(next.size(), 1u);
    EXPECT_EQ(next[0].seq, reset->seq + 1);
}

TEST_F(ChangeFeedTest, ConnectionLost_WhatWaitedIsPartOfTheNextReset) {
    apply(description("uno1"));
    feed.end();
    feed.begin("e-2");
    feed.complete();
    const auto reset = feed.reset(now, 0);
    ASSERT_TRUE(reset);
    EXPECT_EQ(reset->seq, 1u);
    EXPECT_TRUE(drain().empty());
}

TEST_F(ChangeFeedTest, AddedAndForgottenWhileBehind_IsNeverHeardOfAndItsNameMayComeAgain) {
    apply(description("uno1"));
    feed.change({Kind::kForgotten, "uno1"});
    EXPECT_EQ(feed.waiting(), 0u);
    feed.change({Kind::kAdded, "uno1", 0, BoardState::kOnline});
    EXPECT_EQ(drain().size(), 1u);
    EXPECT_EQ(feed.seq(), 1u);
}

Event event(Kind kind, BoardState state = BoardState::kOnline, BoardState was = BoardState::kLost) {
    return {kind, "uno1", 0, state, was, model::StateReason::kStopped};
}

TEST(ChangesTogether, AreWhatAWatcherNeedsToKnow) {
    const auto went = event(Kind::kState, BoardState::kLost, BoardState::kOnline);
    const auto slept = event(Kind::kState, BoardState::kSleeping, BoardState::kLost);
    EXPECT_EQ(together(went, slept)->kind, Kind::kState);
    EXPECT_EQ(together(went, slept)->was, BoardState::kOnline);
    EXPECT_EQ(together(went, slept)->state, BoardState::kSleeping);
    EXPECT_EQ(together(went, event(Kind::kState))->kind, Kind::kDescription) << "back where it was";
    EXPECT_EQ(together(event(Kind::kAdded), went)->kind, Kind::kAdded);
    EXPECT_EQ(together(event(Kind::kAdded), went)->state, BoardState::kLost);
    EXPECT_EQ(together(went, event(Kind::kDescription, BoardState::kLost))->kind, Kind::kState);
    EXPECT_EQ(together(went, event(Kind::kForgotten))->kind, Kind::kForgotten);
    EXPECT_EQ(together(event(Kind::kForgotten), event(Kind::kAdded))->kind, Kind::kAdded);
    EXPECT_EQ(together(event(Kind::kConflict), event(Kind::kDescription))->kind, Kind::kConflict);
    EXPECT_EQ(together(event(Kind::kConflict), event(Kind::kResolved))->kind, Kind::kResolved);
    EXPECT_EQ(together(event(Kind::kDescription), went)->kind, Kind::kState);
}

// A watcher that asks in the middle of a burst: its copy equals the catalogue in the end, and each board is
// reported to it once in each of its states.
TEST_F(ChangeFeedTest, SnapshotInTheMiddleOfABurst_WatcherEndsWithTheCatalogueAndHearsNothingTwice) {
    std::vector<std::string> heard;
    bus::CatalogueView view([&](const bus::CatalogueView::Change& change) {
        heard.push_back(change.board.board + " " + change.board.state);
    });
    const auto give_page = [&] {
        auto page = catalogue.find(*view.next_query(), now).value();
        page.registry = "r1";
        page.epoch = "e-1";
        page.seq = feed.seq();
        EXPECT_TRUE(view.page(page));
    };
    const auto give_events = [&](std::size_t count) {
        while (count-- > 0)
            if (const auto next = feed.next(catalogue, now, 0)) view.event(*next);
    };
    for (int i = 0; i < 20; ++i)
        apply(description("uno" + std::to_string(i)));
    give_events(5);
    give_page();
    for (int i = 0; i < 20; i += 2)
        apply(state("uno" + std::to_string(i), "lost"));
    give_events(100);
    ASSERT_TRUE(view.complete());
    ASSERT_EQ(view.boards().size(), 20u);
    for (const auto& [name, item] : view.boards())
        EXPECT_EQ(item.state, catalogue.board(name, now)->state) << name;
    std::sort(heard.begin(), heard.end());
    EXPECT_EQ(std::adjacent_find(heard.begin(), heard.end()), heard.end()) << "nothing twice";
    EXPECT_EQ(heard.size(), 20u + 10u);
}

}  // namespace change_feed_test
}  // namespace asip::registry
