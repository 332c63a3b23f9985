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

}  // namespace
}  // namespace asip::catalogue
