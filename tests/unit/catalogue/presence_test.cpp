// SPDX-License-Identifier: Apache-2.0
// Which program may say the state of a board, over several leases, renewals and probes.
#include <gmock/gmock.h>

#include "catalogue_bench.hpp"

namespace asip::catalogue {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

using Kind = Event::Kind;

const std::string kOldAgent;  // its descriptions hold no state
const std::string kOnline = R"("state":{"is":"online","age":0})";

std::string said(const std::string& word, const std::string& reason, int age) {
    return R"("state":{"is":")" + word + R"(","reason":")" + reason + R"(","age":)" + std::to_string(age) +
           "}";
}

class PresenceTest : public CatalogueTest, public testing::WithParamInterface<bool> {
  protected:
    bool new_agent() const { return GetParam(); }

    OwnedMessage announce(const std::string& word, const std::string& reason, int age) {
        return description("uno1",
                           {.seq = ++seq_, .more = new_agent() ? said(word, reason, age) : kOldAgent});
    }
    void collect(const std::vector<Event::Kind>& kinds) {
        events_.insert(events_.end(), kinds.begin(), kinds.end());
    }
    void comes_online(Duration when) {
        collect(give(announce("online", "", 0), when));
        collect(give(state("uno1", "online"), when));
    }
    void is_unplugged(Duration when) {
        collect(give(announce("lost", "unplugged", 0), when));
        collect(give(state("uno1", "lost"), when));
    }
    void renews(int age, Duration when) { collect(give(announce("lost", "unplugged", age), when)); }
    void answers_probe(int age, Duration when) {
        renews(age, when);
        collect(give(state("uno1", "lost"), when));
        collect(give(board_name("uno1"), when));
        for (const char* service : {"distance", "servo"})
            collect(give(service_name("uno1", service), when));
    }

    std::uint64_t seq_ = 0;
    std::vector<Event::Kind> events_;
};
INSTANTIATE_TEST_SUITE_P(Agents, PresenceTest, testing::Bool(),
                         [](const auto& each) { return each.param ? "WithState" : "WithoutState"; });

TEST_P(PresenceTest, UnpluggedBoardWhoseAgentLives_IsLostForManyLeasesRenewalsAndProbes) {
    comes_online(0s);
    events_.clear();
    is_unplugged(10s);
    EXPECT_THAT(events_, ElementsAre(Kind::kState)) << "one change, one event";
    events_.clear();
    for (int second = 11; second < 600; ++second) {
        const auto when = std::chrono::seconds(second);
        if (second % 19 == 0) renews(second - 10, when);
        if (second % 50 == 0) answers_probe(second - 10, when);
        if (second % 7 == 0) collect(give(traffic("uno1"), when));
        collect(expire(when));
        ASSERT_EQ(state_of("uno1"), "lost") << second;
    }
    EXPECT_THAT(events_, IsEmpty());
    const auto item = board("uno1", 600s);
    EXPECT_EQ(item.since, instant(at(600s)).wall - 590s);
    EXPECT_EQ(item.reason, new_agent() ? "unplugged" : "agent-gone");
    comes_online(600s);
    EXPECT_EQ(state_of("uno1"), "online");
    EXPECT_THAT(events_, ElementsAre(Kind::kState));
    EXPECT_EQ(board("uno1", 600s).reason, "");
}

TEST_P(PresenceTest, AgentThatGoesAway_IsNotTakenBackByWhatWasSaidBefore) {
    comes_online(0s);
    give(state("uno1", "lost"), 10s);
    for (std::uint64_t seq = 1; seq <= seq_; ++seq) {
        give(description("uno1", {.seq = seq, .more = new_agent() ? kOnline : kOldAgent}), 11s);
        give(retained(description("uno1", {.seq = seq, .more = new_agent() ? kOnline : kOldAgent}), 40), 11s);
    }
    give(retained(state("uno1", "online")), 12s);
    EXPECT_EQ(state_of("uno1"), "lost");
    EXPECT_EQ(board("uno1").reason, "agent-gone");
}

TEST_P(PresenceTest, NewerSession_EndsLost) {
    comes_online(0s);
    is_unplugged(10s);
    give(description("uno1", {.session = "6f3a9c01", .seq = 1, .more = new_agent() ? kOnline : kOldAgent}),
         20s);
    EXPECT_EQ(state_of("uno1"), "online");
}

TEST_P(PresenceTest, Goodbye_IsNotTakenBackByItsAgentsLastWords) {
    comes_online(0s);
    const auto late = announce("online", "", 1);
    give(announce("offline", "stopped", 0), 10s);
    give(state("uno1", "offline"), 10s);
    if (new_agent()) give(late, 11s);
    give(service_name("uno1", "distance"), 11s);
    give(board_name("uno1"), 11s);
    EXPECT_EQ(state_of("uno1"), "offline");
    EXPECT_EQ(board("uno1").reason, "stopped");
}

TEST_F(CatalogueTest, WillOfASessionThatRenews_IsTakenBackByItsNextDescription) {
    give(description("uno1", {.seq = 1, .more = kOnline}), 0s);
    EXPECT_THAT(give(state("uno1", "lost"), 1s), ElementsAre(Kind::kState));
    EXPECT_THAT(give(state("uno1", "online"), 2s), IsEmpty()) << "whose word is it?";
    EXPECT_THAT(give(description("uno1", {.seq = 2, .more = R"("state":{"is":"online","age":2})"}), 2s),
                ElementsAre(Kind::kState));
    EXPECT_EQ(state_of("uno1"), "online");
    EXPECT_EQ(board("uno1", 2s).since, instant(at(2s)).wall - 2s) << "it was there all the time";
}

TEST_F(CatalogueTest, OlderSessionOfAnAgent_NeverComesBackWhileALaterOneIsKnown) {
    const std::string older = "00673f0000aaaaaa";
    const std::string later = "00673f0100000000";
    give(description("uno1", {.session = later, .seq = 1, .more = kOnline}), 0s);
    give(description("uno1", {.session = older, .seq = 9, .services = "[]"}), 1s);
    EXPECT_EQ(board("uno1").session, later);
    give(state("uno1", "lost"), 2s);
    give(description("uno1", {.session = older, .seq = 10, .services = "[]"}), 3s);
    EXPECT_EQ(refused, Refusal::kOldSession);
    EXPECT_EQ(state_of("uno1"), "lost");
    give(description("uno1", {.session = older, .seq = 11}), 70s);
    EXPECT_EQ(state_of("uno1"), "online") << "its clock went back, and nothing renews the other one";
}

TEST_F(CatalogueTest, LeaseRunsOut_SaysSoAndTheAgentsWordCountsAgainWhenItIsHeard) {
    give(description("uno1", {.seq = 1, .more = kOnline}), 0s);
    expire(60s);
    EXPECT_EQ(board("uno1").reason, "expired");
    EXPECT_EQ(board("uno1", 60s).since, instant(at(60s)).wall);
    give(description("uno1", {.seq = 2, .more = R"("state":{"is":"online","age":90})"}), 90s);
    EXPECT_EQ(state_of("uno1"), "online");
    EXPECT_EQ(board("uno1").reason, "");
    EXPECT_EQ(board("uno1", 90s).since, instant(at(90s)).wall - 90s);
}

TEST_F(CatalogueTest, LateJoiner_KnowsStateReasonAndTimeOfOneThatWasThereAllAlong) {
    const auto lost = description("uno1", {.seq = 2, .more = said("lost", "unplugged", 0)});
    give(description("uno1", {.seq = 1, .more = kOnline}), 0s);
    give(lost, 100s);
    give(state("uno1", "lost"), 100s);
    for (const bool state_first : {true, false}) {
        Catalogue late;
        const auto stored = retained(lost, 55);
        const auto word = retained(state("uno1", "lost"), model::kStateExpirySeconds - 5);
        late.apply((state_first ? word : stored).view(), at(105s));
        late.apply((state_first ? stored : word).view(), at(105s));
        const auto item = *late.board("uno1", instant(at(105s)));
        const auto known = board("uno1", 105s);
        EXPECT_EQ(item.state, known.state);
        EXPECT_EQ(item.reason, known.reason);
        EXPECT_EQ(item.since, known.since);
    }
}

TEST_F(CatalogueTest, LateJoinerBehindAWill_KnowsSinceWhen) {
    for (const bool state_first : {true, false}) {
        Catalogue late;
        const auto stored = retained(description("uno1", {.seq = 2, .more = kOnline}), 30);
        const auto word = retained(state("uno1", "lost"), model::kStateExpirySeconds - 5);
        late.apply((state_first ? word : stored).view(), at(100s));
        late.apply((state_first ? stored : word).view(), at(100s));
        const auto item = *late.board("uno1", instant(at(100s)));
        EXPECT_EQ(item.state, "lost");
        EXPECT_EQ(item.reason, "agent-gone");
        EXPECT_EQ(item.since, instant(at(100s)).wall - 5s);
        late.apply(description("uno1", {.seq = 3, .more = kOnline}).view(), at(101s));
        EXPECT_EQ(late.board("uno1", instant(at(101s)))->state, "online");
    }
}

TEST_F(CatalogueTest, StoredStateThatABridgeDeliversAgain_IsOlderThanWhatItsAgentSaidSince) {
    auto word = state("uno1", "lost");
    give(description("uno1", {.seq = 1, .more = kOnline}), 0s);
    give(description("uno1", {.seq = 2, .more = R"("state":{"is":"online","age":20})"}), 20s);
    word.expiry_seconds = model::kStateExpirySeconds - 15;
    give(word, 25s);
    EXPECT_EQ(refused, Refusal::kOldHint);
    EXPECT_EQ(state_of("uno1"), "online");
    word.expiry_seconds = model::kStateExpirySeconds;
    give(word, 26s);
    EXPECT_EQ(state_of("uno1"), "lost");
}

TEST_F(CatalogueTest, WillBehindAStop_CountsForThoseThatHeardBothAndThoseThatCameLater) {
    give(description("uno1", {.more = kOnline}));
    give(description("uno1", {.seq = 2, .more = said("offline", "stopped", 0)}), 5s);
    give(state("uno1", "offline"), 5s);
    EXPECT_EQ(board("uno1").reason, "stopped");
    give(state("uno1", "lost"), 20s);  // of an agent that claimed the name and died
    EXPECT_EQ(state_of("uno1"), "lost");
    EXPECT_EQ(board("uno1").reason, "agent-gone");
    give(description("uno1", {.session = "t", .seq = 1, .more = kOnline}), 30s);
    EXPECT_EQ(state_of("uno1"), "online");
}

TEST_F(CatalogueTest, StopWhileTheBusWasNotHeard_CountsWhereItsDescriptionHasExpired) {
    give(description("uno1", {.more = said("lost", "silent", 0)}));
    catalogue.suspend();
    catalogue.resume(at(100s));
    auto stopped = retained(state("uno1", "offline"));
    stopped.expiry_seconds = model::kStateExpirySeconds - 60;
    give(stopped, 100s);
    EXPECT_EQ(state_of("uno1"), "offline");
    EXPECT_EQ(board("uno1", 100s).state_age, 60);
    auto older = retained(state("uno1", "lost"));
    older.expiry_seconds = model::kStateExpirySeconds - 200;
    give(older, 100s);
    EXPECT_EQ(state_of("uno1"), "offline") << "stored before it was stopped";
}

TEST_F(CatalogueTest, LaterSessionInTheSameState_IsInItSinceItSaysSo) {
    give(description("uno1", {.more = kOnline}));
    give(description("uno1", {.session = "t", .seq = 1, .more = kOnline}), 3s);
    EXPECT_EQ(board("uno1", 10s).state_age, 7);
}

TEST_F(CatalogueTest, LeaseThatIsJudgedLate_RanOutWhenItDid) {
    give(description("uno1", {.lease = 10, .more = kOnline}));
    catalogue.expire(at(100s));
    EXPECT_EQ(board("uno1", 100s).state_age, 90);
}

TEST_F(CatalogueTest, StateThatCannotBeRead_IsRefusedAndTheNextOneCounts) {
    give(description("uno1", {.seq = 1, .more = kOnline}));
    for (const char* bad :
         {R"("state":"lost")", R"("state":{"is":"dead"})", R"("state":{"is":"lost","age":-1})",
          R"("state":{"is":"lost","age":1e400})", R"("state":{"age":1})", R"("state":{"is":1})"}) {
        give(description("uno1", {.seq = 2, .more = bad}));
        EXPECT_EQ(refused, Refusal::kMalformed) << bad;
        EXPECT_EQ(state_of("uno1"), "online");
    }
    give(description("uno1", {.seq = 2, .more = said("lost", "a-later-reason", 3)}));
    EXPECT_EQ(state_of("uno1"), "lost");
    EXPECT_EQ(board("uno1").reason, "");
}

}  // namespace
}  // namespace asip::catalogue
