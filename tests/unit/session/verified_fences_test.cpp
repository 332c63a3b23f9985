// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/session/scripted_board.hpp"

namespace asip::session {
namespace {

class VerifiedFences : public testing::TestWithParam<ChecksumPolicy> {
  protected:
    explicit VerifiedFences(unsigned fastest = 1'000'000) : bench({.checksum = GetParam()}) {
        bench.board.verified_fences = true;
        bench.board.fastest_allowed = fastest;
        EXPECT_TRUE(bench.start());
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

class FullBatches : public VerifiedFences {
  protected:
    using VerifiedFences::VerifiedFences;
    /// Twenty requests, while the board's answers wait. It loses the fences behind so many of them.
    void send_twenty(int fences_until = 20) {
        bench.board.heard.clear();
        bench.hold();
        for (int i = 0; i < 20; ++i) {
            if (i == fences_until) bench.board.swallow_fences = 100;
            requests.push_back(bench.request("I,d,13," + std::to_string(i % 2), {.client = 7}));
        }
    }
    bool all_executed() const {
        return std::all_of(requests.begin(), requests.end(), [&](RequestId id) {
            const auto* const end = bench.end_of(id);
            return end != nullptr && end->ending == Ending::kExecuted;
        });
    }
    auto fences() const {
        return std::count_if(bench.board.heard.begin(), bench.board.heard.end(),
                             [](const auto& line) { return line.starts_with("#,V"); });
    }
    std::vector<RequestId> requests;
};
INSTANTIATE_TEST_SUITE_P(Checksums, FullBatches,
                         testing::Values(ChecksumPolicy::kNever, ChecksumPolicy::kAlways),
                         [](const auto& tested) -> std::string {
                             return tested.param == ChecksumPolicy::kNever ? "Without" : "With";
                         });

TEST_P(FullBatches, OnAFastLine_AFenceForAsManyAsTheBoardHolds) {
    send_twenty();
    const auto at_once = fences();
    bench.release();
    bench.pass(1s);
    EXPECT_TRUE(all_executed());
    EXPECT_LE(fences(), at_once + 5);
    EXPECT_LE(bench.most_in_flight, 63u);
}

TEST_P(FullBatches, AnAnswerIsMissing_TheFenceIsSentAllTheSame) {
    send_twenty(1);
    const auto at_once = fences();
    bench.board.swallow_fences = 0;
    bench.release();
    bench.pass(50ms);
    EXPECT_EQ(fences(), at_once);
    bench.pass(100ms);
    EXPECT_GT(fences(), at_once);
    bench.pass(1s);
    EXPECT_EQ(bench.ending(requests.back()), Ending::kExecuted);
}

class FullBatchesOnASlowLine : public FullBatches {
  protected:
    FullBatchesOnASlowLine() : FullBatches(57600) {}
};
INSTANTIATE_TEST_SUITE_P(Checksums, FullBatchesOnASlowLine, testing::Values(ChecksumPolicy::kAlways));

TEST_P(FullBatchesOnASlowLine, EachFenceIsSentAtOnce) {
    send_twenty(1);
    const auto at_once = fences();
    bench.board.swallow_fences = 0;
    bench.release();
    bench.pass(50ms);
    EXPECT_GT(fences(), at_once);
}

// Requests that look alike go with one fence, so an error of theirs names none of them.
class AlikeRequests : public VerifiedFences {
  protected:
    AlikeRequests() {
        bench.board.replies["S,W,0,90"] = "";
        bench.board.replies["S,W,1,90"] = "";
        bench.board.replies["S,W,8,90"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
        bench.board.replies["S,W,9,90"] = "~S,W,11{BAD_ARGUMENT}";
        // They wait together behind one that is under way.
        bench.board.heard.clear();
        bench.hold();
        before = bench.request("I,d,13,1" + std::string(38, ' '), {.client = 7});
    }
    RequestId send(const std::string& line, ClientId client = 7) {
        return bench.request(line, {.client = client});
    }
    void settle() {
        bench.release();
        bench.pass(1s);
        ASSERT_EQ(bench.ending(before), Ending::kExecuted);
    }
    Ending ending(RequestId id) const { return bench.end_of(id)->ending; }
    std::size_t fences() const {
        return std::size_t(std::count_if(bench.board.heard.begin(), bench.board.heard.end(),
                                         [](const auto& line) { return line.starts_with("#,V"); }));
    }
    RequestId before = 0;
};
INSTANTIATE_TEST_SUITE_P(Checksums, AlikeRequests,
                         testing::Values(ChecksumPolicy::kNever, ChecksumPolicy::kAlways),
                         [](const auto& tested) -> std::string {
                             return tested.param == ChecksumPolicy::kNever ? "Without" : "With";
                         });

TEST_P(AlikeRequests, OfOneClient_ShareAFence) {
    const auto first = send("S,W,0,90"), second = send("S,W,1,90"), third = send("S,W,0,90");
    settle();
    for (const auto id : {first, second, third})
        EXPECT_EQ(ending(id), Ending::kExecuted);
    EXPECT_EQ(fences(), 2u);
}

TEST_P(AlikeRequests, OneHasAnError_TheDigestSaysWhich) {
    const auto first = send("S,W,0,90"), second = send("S,W,8,90"), third = send("S,W,1,90");
    settle();
    EXPECT_EQ(ending(first), Ending::kExecuted);
    ASSERT_EQ(ending(second), Ending::kBoardError);
    EXPECT_EQ(bench.end_of(second)->code, 7);
    EXPECT_EQ(ending(third), Ending::kExecuted);
    EXPECT_EQ(bench.session.counters().contradictions, 0u);
    EXPECT_THAT(bench.owned_lines,
                testing::Contains(testing::Pair("~S,W,7{INVALID_DEVICE_NUMBER}", testing::Optional(7u))));
}

TEST_P(AlikeRequests, TwoHaveErrors_EachHasItsOwn) {
    const auto first = send("S,W,9,90"), second = send("S,W,0,90"), third = send("S,W,8,90");
    settle();
    ASSERT_EQ(ending(first), Ending::kBoardError);
    EXPECT_EQ(bench.end_of(first)->code, 11);
    // Without checksums, a line that was refused for its syntax may have been two.
    EXPECT_EQ(ending(second), GetParam() == ChecksumPolicy::kAlways ? Ending::kExecuted : Ending::kDoubt);
    ASSERT_EQ(ending(third), Ending::kBoardError);
    EXPECT_EQ(bench.end_of(third)->code, 7);
}

TEST_P(AlikeRequests, ErrorIsLost_AllAreInDoubt) {
    bench.board.lost_errors["S,W,1,90"] = 7;
    const auto first = send("S,W,0,90"), second = send("S,W,1,90");
    settle();
    EXPECT_EQ(ending(first), Ending::kDoubt);
    EXPECT_EQ(ending(second), Ending::kDoubt);
}

TEST_P(AlikeRequests, ErrorComesThoughNoneHadOne_AllAreInDoubt) {
    bench.board.replies["S,W,1,90"] = "~S,W,7{INVALID_DEVICE_NUMBER}\r\n~S,W,7{INVALID_DEVICE_NUMBER}";
    const auto first = send("S,W,0,90"), second = send("S,W,1,90");
    settle();
    EXPECT_EQ(ending(first), Ending::kDoubt);
    EXPECT_EQ(ending(second), Ending::kDoubt);
}

// A digest has 16 bits: it is 17564 whether the errors are those of the first two or of the last two.
TEST_P(AlikeRequests, TwoExplanationsHaveOneDigest_AllAreInDoubt) {
    bench.board.replies["I,a,3"] = "~I,a,11{BAD_ARGUMENT}";
    bench.board.replies["I,d,99,1"] = "~I,d,3{INVALID_PIN}";
    const auto first = send("I,a,3"), second = send("I,d,99,1"), third = send("I,a,11,180"),
               fourth = send("I,d,2,1");
    settle();
    for (const auto id : {first, second, third, fourth})
        EXPECT_EQ(ending(id), Ending::kDoubt);
}

TEST_P(AlikeRequests, OfTwoClients_AnErrorGoesToItsOwnAlone) {
    const auto first = send("S,W,0,90", 7), second = send("S,W,8,90", 8);
    settle();
    EXPECT_EQ(ending(first), Ending::kExecuted);
    EXPECT_EQ(ending(second), Ending::kBoardError);
    EXPECT_THAT(bench.owned_lines,
                testing::Contains(testing::Pair("~S,W,7{INVALID_DEVICE_NUMBER}", testing::Optional(8u))));
}

TEST_P(VerifiedFences, ManyRequestsOfManyClients_AllAreProven) {
    std::vector<RequestId> ids;
    for (int i = 0; i < 200; ++i)
        ids.push_back(bench.request(i % 3 ? "I,d,13,1 " : "S,W,0,90", {.client = ClientId(i % 7)}));
    bench.pass(5s);
    for (const auto id : ids)
        ASSERT_EQ(bench.ending(id), Ending::kExecuted);
    EXPECT_EQ(bench.session.counters().contradictions, 0u);
}

TEST_P(VerifiedFences, RequestThatBeginsTheDigestAnew_IsForTheSessionAlone) {
    EXPECT_EQ(bench.refused("#,V,mine"), Refusal::kInvalid);
}

}  // namespace
}  // namespace asip::session
