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

}  // namespace
}  // namespace asip::catalogue
