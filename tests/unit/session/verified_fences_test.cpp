#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/session/scripted_board.hpp"

namespace asip::session {
namespace {

class VerifiedFences : public testing::TestWithParam<ChecksumPolicy> {
  protected:
    VerifiedFences() : bench({.checksum = GetParam()}) {
        bench.board.verified_fences = true;
        bench.plug();
        EXPECT_TRUE(bench.ready_within());
        EXPECT_EQ(ending_of("I,d,13,0"), Ending::kExecuted);
    }
    std::optional<Ending> ending_of(const std::string& line) {
        const auto id = bench.request(line);
        bench.pass(1s);
        const auto* const end = bench.end_of(id);
        return end ? std::optional(end->ending) : std::nullopt;
    }
    Bench bench;
};
INSTANTIATE_TEST_SUITE_P(Checksums, VerifiedFences,
                         testing::Values(ChecksumPolicy::kNever, ChecksumPolicy::kAlways),
                         [](const auto& tested) -> std::string {
                             return tested.param == ChecksumPolicy::kNever ? "Without" : "With";
                         });

TEST_P(VerifiedFences, WholeRequestIsLostWithItsLineEnd_DoubtAndTheNextIsProven) {
    bench.board.lose_lines = 1;
    EXPECT_EQ(ending_of("I,d,13,1"), Ending::kDoubt);
    EXPECT_EQ(bench.session.counters().contradictions, 1u);
    EXPECT_EQ(ending_of("I,d,13,1"), Ending::kExecuted);
}

TEST_P(VerifiedFences, RequestBecomesAnotherOfTheSameChecksum_DoubtAndTheNextIsProven) {
    bench.board.misreads["I,d,13,1"] = "I,d,12,0";
    EXPECT_EQ(ending_of("I,d,13,1"), Ending::kDoubt);
    bench.board.misreads.clear();
    EXPECT_EQ(ending_of("I,d,13,1"), Ending::kExecuted);
}

TEST_P(VerifiedFences, ErrorOfTheBoardIsLost_DoubtNotOk) {
    bench.board.replies["S,W,9,90"] = "";
    EXPECT_EQ(ending_of("S,W,9,90"), Ending::kExecuted);
    bench.board.lost_errors["S,W,9,90"] = 7;
    EXPECT_EQ(ending_of("S,W,9,90"), Ending::kDoubt);
    bench.board.replies["S,W,8,90"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    EXPECT_EQ(ending_of("S,W,8,90"), Ending::kBoardError);
}

TEST_P(VerifiedFences, ErrorOfOneOfTwoThatLookAlike_IsNoContradiction) {
    bench.board.replies["S,W,8,90"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    bench.request("S,W,8,90", {.prove = false});
    bench.request("S,W,0,90", {.prove = false});
    EXPECT_EQ(ending_of("I,d,13,1"), Ending::kExecuted);
    EXPECT_EQ(bench.session.counters().contradictions, 0u);
}

TEST_P(VerifiedFences, ManyRequestsOfManyClients_AllAreProven) {
    std::vector<RequestId> ids;
    for (int i = 0; i < 200; ++i)
        ids.push_back(bench.request(i % 3 ? "I,d,13,1 " : "S,W,0,90", {.client = ClientId(i % 7)}));
    bench.pass(5s);
    for (const auto id : ids)
        ASSERT_EQ(bench.end_of(id)->ending, Ending::kExecuted);
    EXPECT_EQ(bench.session.counters().contradictions, 0u);
}

TEST_P(VerifiedFences, RequestThatBeginsTheDigestAnew_IsForTheSessionAlone) {
    EXPECT_EQ(bench.refused("#,V,mine"), Refusal::kInvalid);
}

}  // namespace
}  // namespace asip::session
