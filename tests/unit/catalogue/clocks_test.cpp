// SPDX-License-Identifier: Apache-2.0
// Agents whose clock went back: their session is an earlier one than that of the agent before them.
#include <gmock/gmock.h>

#include "catalogue_bench.hpp"

namespace asip::catalogue {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

using Kind = Event::Kind;

const std::string kEarlier = "0000000001aaaaaa";
const std::string kLater = "0000000002aaaaaa";

OwnedMessage says(const std::string& session, std::uint64_t seq, const std::string& word = "online",
                  int age = 1) {
    return description("uno1",
                       {.session = session,
                        .seq = seq,
                        .more = R"("state":{"is":")" + word + R"(","age":)" + std::to_string(age) + "}"});
}

class ClocksTest : public CatalogueTest {
  protected:
    std::string holder() { return board("uno1").session; }
    double age(Duration when) { return board("uno1", when).state_age; }
};

TEST_F(ClocksTest, EarlierSessionWithinTheLeaseOfTheLaterOne_IsRefusedHoweverTheLaterOneEnded) {
    Duration now = 0s;
    std::uint64_t seq = 0;
    for (const std::string end : {"online", "lost", "offline", "updating"}) {
        give(says(kLater, ++seq, end), now += 10s);
        give(says(kEarlier, seq), now += 59s);
        EXPECT_NE(refused, std::nullopt) << end;
        EXPECT_EQ(holder(), kLater);
    }
}

TEST_F(ClocksTest, EarlierSessionWithinTheLeaseOfTheLaterOne_CountsNotEvenWhereABridgeDeliversItAgainLater) {
    give(says(kLater, 1));
    give(says(kEarlier, 7), 30s);
    expire(60s);
    give(says(kEarlier, 7), 70s);
    EXPECT_EQ(refused, Refusal::kOldSession);
    EXPECT_EQ(state_of("uno1"), "lost");
    give(says(kEarlier, 8), 71s);
    EXPECT_EQ(state_of("uno1"), "online");
}

TEST_F(ClocksTest, EarlierSessionBehindTheLeaseOfTheLaterOne_CountsAndTheLaterOneComesBackAtOnce) {
    give(says(kLater, 3));
    EXPECT_THAT(expire(60s), ElementsAre(Kind::kState, Kind::kGhost));
    EXPECT_THAT(give(says(kEarlier, 1), 61s), ElementsAre(Kind::kState, Kind::kDescription));
    EXPECT_EQ(holder(), kEarlier);
    give(says(kLater, 3), 62s);
    EXPECT_EQ(refused, Refusal::kOldSession) << "it said that before";
    EXPECT_THAT(give(says(kLater, 4, "online", 63), 63s), ElementsAre(Kind::kDescription));
    EXPECT_EQ(holder(), kLater);
    EXPECT_EQ(age(63s), 63) << "its board never was away";
    give(says(kEarlier, 2), 64s);
    EXPECT_EQ(refused, Refusal::kConflict);
    EXPECT_EQ(holder(), kLater);
}

TEST_F(ClocksTest, NamesOfTheEarlierSessionAheadOfItsDescription_KeepNoLaterSessionAlive) {
    give(says(kLater, 3));
    expire(60s);
    give(board_name("uno1"), 61s);
    give(service_name("uno1", "servo"), 61s);
    give(says(kEarlier, 1), 61s);
    EXPECT_EQ(refused, std::nullopt);
    EXPECT_EQ(holder(), kEarlier);
    EXPECT_EQ(age(61s), 1);
    for (std::uint64_t seq = 2; seq < 9; ++seq) {
        give(says(kEarlier, seq), 61s + (seq - 1) * 20s);
        EXPECT_THAT(expire(61s + (seq - 1) * 20s), IsEmpty());
        EXPECT_EQ(refused, std::nullopt);
    }
}

TEST_F(ClocksTest, LeaseThatEndedWhileTheBusWasNotHeard_GraceKeepsNoLaterSessionAlive) {
    give(says(kLater, 3));
    catalogue.suspend();
    catalogue.resume(at(70s));
    give(says(kEarlier, 5, "online", 4), 71s);
    EXPECT_EQ(refused, std::nullopt);
    EXPECT_EQ(holder(), kEarlier);
    EXPECT_EQ(age(71s), 4);
}

TEST_F(ClocksTest, StoredDescriptionOfAnEarlierSession_CountsWhereItWasPublishedBehindTheLeaseOfTheLaterOne) {
    give(says(kLater, 3));
    expire(60s);
    give(retained(says(kEarlier, 5), 30), 80s);
    EXPECT_EQ(refused, Refusal::kOldSession) << "it was published 50 s after the start";
    give(retained(says(kEarlier, 5)), 80s);
    EXPECT_EQ(refused, Refusal::kOldSession) << "nobody knows when";
    EXPECT_EQ(state_of("uno1"), "lost");
    give(retained(says(kEarlier, 6), 45), 80s);
    EXPECT_EQ(refused, std::nullopt);
    EXPECT_EQ(holder(), kEarlier);
    EXPECT_EQ(state_of("uno1"), "online");
    EXPECT_EQ(age(80s), 16);
}

TEST_F(ClocksTest, StoredDescriptionOfALaterSessionThatWasReplaced_Counts) {
    give(says(kLater, 3));
    expire(60s);
    give(says(kEarlier, 1), 61s);
    give(retained(says(kLater, 3), 5), 62s);
    EXPECT_EQ(refused, Refusal::kOldSession);
    give(retained(says(kLater, 4), 59), 62s);
    EXPECT_EQ(holder(), kLater);
}

TEST_F(ClocksTest, FirstDescriptionBehindAStoredWordOfAnotherAgent_SaysSinceWhen) {
    give(retained(state("uno1", "online"), model::kStateExpirySeconds - 3));
    give(says(kEarlier, 1, "online", 1), 1s);
    EXPECT_EQ(age(1s), 1) << "the stored word, of 4 s ago, was of an earlier session";
}

TEST_F(ClocksTest, StoredWordThatWasHeardLive_SaysNothingNew) {
    give(retained(state("uno1", "online"), model::kStateExpirySeconds - 9));
    auto will = state("uno1", "lost");
    will.expiry_seconds = model::kStateExpirySeconds;
    give(will, 10s);
    give(will, 17s);
    catalogue.suspend();
    catalogue.resume(at(25s));
    give(retained(will, model::kStateExpirySeconds - 8), 25s);
    EXPECT_EQ(age(25s), 15) << "it was lost already when the second will came";
    give(retained(will, model::kStateExpirySeconds - 3), 25s);
    EXPECT_EQ(age(25s), 3) << "it may have been back while nothing was heard";
}

TEST_F(ClocksTest, WillSoonBehindAStop_CountsForALateJoiner) {
    give(retained(says(kLater, 3, "offline", 0), 58));
    give(retained(state("uno1", "lost"), model::kStateExpirySeconds - 1));
    EXPECT_EQ(state_of("uno1"), "lost");
}

TEST_F(ClocksTest, StopSoonBehindAnUnpluggedCable_CountsInWhicheverOrderItsStoredMessagesCome) {
    give(says(kLater, 3, "lost", 0));
    catalogue.suspend();
    catalogue.resume(at(4s));
    give(retained(state("uno1", "offline"), model::kStateExpirySeconds - 3), 4s);
    EXPECT_EQ(state_of("uno1"), "offline");
    give(retained(says(kLater, 4, "offline", 0), 57), 4s);
    EXPECT_EQ(refused, std::nullopt);
    EXPECT_EQ(state_of("uno1"), "offline");
}

}  // namespace
}  // namespace asip::catalogue
