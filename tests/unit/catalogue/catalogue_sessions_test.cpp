// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "catalogue_bench.hpp"

namespace asip::catalogue {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

using Kind = Event::Kind;

TEST_F(CatalogueTest, RestartedAgent_TakesOverAtOnceAndReplaysOfTheOldSessionChangeNothing) {
    give(description("uno1", {.session = "a", .seq = 40}));
    EXPECT_THAT(give(description("uno1", {.session = "b", .seq = 1})), ElementsAre(Kind::kDescription));
    for (std::uint64_t seq = 1; seq <= 40; ++seq) {
        EXPECT_THAT(give(description("uno1", {.session = "a", .seq = seq, .services = "[]"})), IsEmpty());
        EXPECT_EQ(refused, Refusal::kOldSession);
    }
    EXPECT_EQ(board("uno1").session, "b");
    EXPECT_EQ(board("uno1").services.size(), 2u);
}

TEST_F(CatalogueTest, TwoLivingSessions_OneConflictReportedAndNoAlternation) {
    give(description("uno1", {.session = "a", .seq = 1}), 0s);
    give(description("uno1", {.session = "b", .seq = 1}), 1s);
    std::vector<Kind> all;
    std::vector<std::string> holders;
    for (std::uint64_t round = 2; round < 12; ++round) {
        for (const char* session : {"a", "b"}) {
            const auto events = give(description("uno1", {.session = session, .seq = round}), round * 1s);
            all.insert(all.end(), events.begin(), events.end());
            holders.push_back(board("uno1").session);
        }
    }
    EXPECT_THAT(all, ElementsAre(Kind::kConflict));
    EXPECT_THAT(holders, testing::Each("b"));
    const auto item = board("uno1");
    ASSERT_TRUE(item.conflict);
    EXPECT_EQ(item.conflict->holder, "b");
    EXPECT_EQ(item.conflict->other, "a");
    EXPECT_EQ(item.conflict->other_agent, "pi asip-agent-1");
    EXPECT_EQ(catalogue.stats().conflicts, 1u);
}

TEST_F(CatalogueTest, TwoLivingSessionsWithTheSmallerLast_TheLargerStillEndsAsHolder) {
    give(description("uno1", {.session = "b", .seq = 1}), 0s);
    give(description("uno1", {.session = "a", .seq = 1}), 1s);
    int changes_of_hand = 0;
    std::string holder = "a";
    for (std::uint64_t round = 2; round < 12; ++round) {
        for (const char* session : {"b", "a"}) {
            give(description("uno1", {.session = session, .seq = round}), round * 1s);
            if (board("uno1").session != holder) ++changes_of_hand;
            holder = board("uno1").session;
        }
    }
    EXPECT_EQ(holder, "b");
    EXPECT_EQ(changes_of_hand, 1);
    EXPECT_EQ(catalogue.stats().conflicts, 1u);
}

TEST_F(CatalogueTest, OneMessageOfTheReplacedSessionUnderWay_IsNoConflict) {
    give(description("uno1", {.session = "a", .seq = 1}), 0s);
    give(description("uno1", {.session = "b", .seq = 1}), 1s);
    give(description("uno1", {.session = "a", .seq = 2}), 1s);
    for (std::uint64_t seq = 2; seq < 9; ++seq)
        EXPECT_THAT(give(description("uno1", {.session = "b", .seq = seq}), seq * 20s), IsEmpty());
    EXPECT_EQ(board("uno1").session, "b");
    EXPECT_FALSE(board("uno1").conflict);
}

TEST_F(CatalogueTest, OtherSessionFallsSilent_ConflictIsResolved) {
    give(description("uno1", {.session = "a", .seq = 1}), 0s);
    give(description("uno1", {.session = "b", .seq = 1}), 1s);
    give(description("uno1", {.session = "a", .seq = 2}), 2s);
    give(description("uno1", {.session = "b", .seq = 2}), 3s);
    EXPECT_THAT(give(description("uno1", {.session = "a", .seq = 3}), 4s), ElementsAre(Kind::kConflict));
    EXPECT_THAT(give(description("uno1", {.session = "b", .seq = 3}), 40s), IsEmpty());
    EXPECT_THAT(give(description("uno1", {.session = "b", .seq = 4}), 64s), ElementsAre(Kind::kResolved));
    EXPECT_EQ(catalogue.stats().conflicts, 0u);
}

TEST_F(CatalogueTest, HolderFallsSilent_OtherSessionHoldsTheBoard) {
    give(description("uno1", {.session = "a", .seq = 1}), 0s);
    give(description("uno1", {.session = "b", .seq = 1}), 1s);
    give(description("uno1", {.session = "a", .seq = 2}), 2s);
    give(description("uno1", {.session = "b", .seq = 2}), 3s);
    give(description("uno1", {.session = "a", .seq = 3}), 50s);
    EXPECT_THAT(expire(63s), ElementsAre(Kind::kState, Kind::kResolved, Kind::kGhost));
    give(description("uno1", {.session = "a", .seq = 4}), 64s);
    EXPECT_EQ(state_of("uno1"), "online");
    EXPECT_EQ(board("uno1").session, "a");
}

TEST_F(CatalogueTest, RetainedDescriptionWithExpiry_LivesForWhatIsLeft) {
    give(retained(description("uno1"), 17));
    EXPECT_EQ(state_of("uno1"), "online");
    EXPECT_THAT(expire(17s), ElementsAre(Kind::kState));
}

TEST_F(CatalogueTest, RetainedDescriptionWithoutExpiry_LivesForItsLease) {
    give(retained(description("uno1")));
    EXPECT_EQ(state_of("uno1"), "online");
    EXPECT_THAT(expire(60s - 1ns), IsEmpty()) << "it may have been announced just before";
    EXPECT_EQ(state_of("uno1"), "online");
    EXPECT_THAT(expire(60s), ElementsAre(Kind::kState, Kind::kGhost));
    give(retained(description("uno1")), 61s);
    EXPECT_EQ(state_of("uno1"), "lost") << "the same replay again proves nothing";
}

TEST_F(CatalogueTest, RetainedDescriptionWithoutExpiry_TheSameAgainDoesNotProlongIt) {
    give(retained(description("uno1")));
    catalogue.suspend();
    catalogue.resume(at(45s));
    give(retained(description("uno1")), 45s);
    EXPECT_THAT(expire(60s), ElementsAre(Kind::kState, Kind::kGhost));
}

TEST_F(CatalogueTest, RetainedDescriptionWithoutExpiry_BoardThatWasToldLostIsLostAtOnce) {
    give(retained(description("uno1")));
    EXPECT_THAT(give(retained(state("uno1", "lost"))), ElementsAre(Kind::kState));
    EXPECT_EQ(state_of("uno1"), "lost");
    EXPECT_THAT(expire(61s), IsEmpty());
}

TEST_F(CatalogueTest, KnownFromRetainedMessagesOnly_ItsAgeIsUnknownInEachForm) {
    give(retained(description("uno1"), 60));
    bus::Query query;
    query.brief = true;
    auto brief = catalogue.find(query, instant(at(5s)));
    ASSERT_TRUE(brief);
    ASSERT_EQ(brief->brief->size(), 1u);
    EXPECT_LT(brief->brief->rows().front().age, 0);
    query.brief = false;
    const auto whole = catalogue.find(query, instant(at(5s)));
    ASSERT_TRUE(whole);
    const auto read = bus::parse_answer(bus::encode(*whole));
    ASSERT_TRUE(read);
    EXPECT_LT(read->boards.at(0).age, 0);
    give(description("uno1", {.seq = 2}), 6s);
    EXPECT_EQ(board("uno1", 8s).age, 2);
}

TEST_F(CatalogueTest, RetainedStateAlone_MakesNoBoardAlive) {
    EXPECT_THAT(give(retained(state("uno1", "online"))), ElementsAre(Kind::kAdded));
    EXPECT_EQ(state_of("uno1"), "lost");
    EXPECT_THAT(give(description("uno1")), ElementsAre(Kind::kState, Kind::kDescription));
    EXPECT_EQ(state_of("uno1"), "online");
}

TEST_F(CatalogueTest, ReplayedStateAgainstALivingBoard_IsOnlyAHint) {
    give(description("uno1", {.more = R"("state":{"is":"online","age":0})"}));
    give(retained(state("uno1", "lost")));
    EXPECT_EQ(refused, Refusal::kOldHint);
    EXPECT_EQ(state_of("uno1"), "online");
    catalogue.suspend();
    catalogue.resume(at(5s));
    give(retained(state("uno1", "offline")), 5s);
    EXPECT_EQ(state_of("uno1"), "offline") << "it may have said so while we were away";
}

TEST_F(CatalogueTest, StoredStateBehindADescriptionThatHoldsNone_Counts) {
    give(description("uno1"));
    give(retained(state("uno1", "lost")));
    EXPECT_EQ(state_of("uno1"), "lost") << "a renewal came between the subscription and what is stored";
    give(description("uno1", {.seq = 2}), 5s);
    EXPECT_EQ(state_of("uno1"), "lost");
    give(state("uno1", "online"), 6s);
    EXPECT_EQ(state_of("uno1"), "online");
    give(retained(state("uno1", "lost")), 6s);
    EXPECT_EQ(refused, Refusal::kOldHint);
}

TEST_F(CatalogueTest, StoredStateBehindAName_Counts) {
    give(board_name("uno1"));
    EXPECT_EQ(state_of("uno1"), "online");
    give(retained(state("uno1", "lost")));
    EXPECT_EQ(state_of("uno1"), "lost") << "an agent whose board is away answers probes, too";
}

TEST_F(CatalogueTest, StoredDescriptionThatSaysNotThere_LateMessageOfAnEarlierSessionDoesNotUndoIt) {
    const std::string earlier = "0000000001aaaaaa";
    const std::string later = "0000000002aaaaaa";
    for (const std::string is : {"lost", "offline", "updating"}) {
        const std::string name = "uno-" + is;
        const auto said =
            description(name, {.session = later, .more = R"("state":{"is":")" + is + R"(","age":1})"});
        give(retained(said, 50));
        give(description(name, {.session = earlier, .seq = 7, .more = R"("state":{"is":"online","age":1})"}),
             1s);
        EXPECT_EQ(refused, Refusal::kOldSession);
        EXPECT_EQ(board(name).session, later);
        EXPECT_EQ(state_of(name), is);
    }
}

TEST_F(CatalogueTest, RetainedDescriptionOfAnUnknownSessionAgainstALivingBoard_IsRefused) {
    give(description("uno1", {.session = "b"}));
    give(retained(description("uno1", {.session = "old", .seq = 99, .services = "[]"})));
    EXPECT_EQ(refused, Refusal::kUnproven);
    EXPECT_EQ(board("uno1").session, "b");
}

TEST_F(CatalogueTest, LiveSessionAfterAnUnprovenRetainedOne_TakesOverWithoutConflict) {
    give(retained(description("uno1", {.session = "old", .seq = 99}), 50));
    give(description("uno1", {.session = "b"}), 1s);
    EXPECT_EQ(board("uno1").session, "b");
    give(retained(description("uno1", {.session = "old", .seq = 99}), 50), 2s);
    EXPECT_EQ(refused, Refusal::kOldSession);
}

}  // namespace
}  // namespace asip::catalogue
