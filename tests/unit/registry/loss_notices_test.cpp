// SPDX-License-Identifier: Apache-2.0
#include "registry/loss_notices.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "messages.hpp"
#include "registry/webhook_address.hpp"

namespace asip::registry {
namespace loss_notices_test {

using model::StateReason;
using nlohmann::json;
using ::testing::HasSubstr;

Instant moment(Duration since_start) {
    return {at(since_start), text::WallTime(std::chrono::milliseconds(1'700'000'000'000)) +
                                 std::chrono::duration_cast<std::chrono::milliseconds>(since_start)};
}

class LossNoticesTest : public ::testing::Test {
  protected:
    void lost(const std::string& board, Duration when, const std::string& host = "vm") {
        notices_.lost(board, host, StateReason::kAgentGone, moment(when));
    }
    json next(Duration when) {
        const auto message = notices_.next(moment(when));
        return message ? json::parse(*message) : json();
    }
    json delivered(Duration when) {
        auto message = next(when);
        notices_.delivered(at(when));
        return message;
    }

    LossNotices notices_{"r1"};
};

TEST_F(LossNoticesTest, OneBoard_IsToldHalfASecondLaterWithItsReason) {
    EXPECT_TRUE(next(0s).is_null());
    lost("desk", 1s);
    EXPECT_TRUE(next(1400ms).is_null()) << "others may follow";
    const auto message = next(1500ms);
    EXPECT_EQ(message["text"], "desk is lost: its agent died or lost the broker (behind host vm)");
    EXPECT_EQ(message["registry"], "r1");
    EXPECT_EQ(message["lost"], json::parse(R"({"count":1,"hosts":{"vm":1},
        "boards":[{"board":"desk","host":"vm","reason":"agent-gone","since":"2023-11-14T22:13:21.000Z"}]})"));
    EXPECT_EQ(message["back"], json::parse(R"({"count":0,"boards":[]})"));
    EXPECT_TRUE(next(60s).is_null()) << "one at a time";
}

TEST_F(LossNoticesTest, AMassLoss_IsOneMessageThatNamesTheMachine) {
    for (int board = 0; board < 2000; ++board)
        lost("board" + std::to_string(board), 1s + board * 100us);
    const auto message = delivered(1500ms);
    EXPECT_EQ(message["text"], "2,000 boards lost, all behind host vm");
    EXPECT_EQ(message["lost"]["count"], 2000);
    EXPECT_EQ(message["lost"]["hosts"], json::parse(R"({"vm":2000})"));
    EXPECT_EQ(message["lost"]["boards"].size(), LossNotices::kMaxNamed);
    EXPECT_TRUE(next(20s).is_null()) << "nothing is left";
}

TEST_F(LossNoticesTest, SeveralMachines_AreCountedTheLargestFirst) {
    for (const char* board : {"a", "b", "c"})
        lost(board, 0s, "pi");
    lost("d", 0s, "vm");
    EXPECT_EQ(next(1s)["text"], "4 boards lost: 3 behind host pi, 1 behind host vm (a, b, c, d)");
    LossNotices others("r1");
    for (int board = 0; board < 10; ++board)
        others.lost("b" + std::to_string(board), board < 4 ? "h" + std::to_string(board) : "",
                    StateReason::kNone, moment(0s));
    EXPECT_EQ(json::parse(*others.next(moment(1s)))["text"],
              "10 boards lost: 1 behind host h0, 1 behind host h1, 1 behind host h2, 7 elsewhere");
}

TEST_F(LossNoticesTest, Messages_AreTenSecondsApartAndGatherWhatHappensMeanwhile) {
    lost("desk", 0s);
    delivered(1s);
    lost("lamp", 2s);
    notices_.back("desk", moment(3s));
    EXPECT_TRUE(next(10s).is_null());
    const auto message = delivered(11s);
    EXPECT_EQ(message["text"],
              "lamp is lost: its agent died or lost the broker (behind host vm); desk is back");
    EXPECT_EQ(message["back"]["count"], 1);
    EXPECT_EQ(message["back"]["boards"][0]["board"], "desk");
    notices_.back("lamp", moment(12s));
    EXPECT_EQ(delivered(30s)["text"], "lamp is back");
}

TEST_F(LossNoticesTest, WhatIsOverBeforeItIsTold_IsNotTold) {
    lost("desk", 0s);
    notices_.back("desk", moment(100ms));
    EXPECT_TRUE(next(5s).is_null());
    notices_.back("shed", moment(5s));
    EXPECT_TRUE(next(8s).is_null()) << "nobody was told that it was lost";
    lost("desk", 8s);
    delivered(9s);
    notices_.back("desk", moment(10s));
    lost("desk", 11s);
    EXPECT_TRUE(next(40s).is_null()) << "known as lost, and lost";
    notices_.back("desk", moment(40s));
    notices_.forgotten("desk");
    EXPECT_TRUE(next(60s).is_null());
}

TEST_F(LossNoticesTest, WhatCannotBeDelivered_IsTriedAgainLaterAndLaterAsOneMessage) {
    lost("desk", 0s);
    ASSERT_FALSE(next(1s).is_null());
    lost("lamp", 1s);
    notices_.failed(at(2s));
    EXPECT_TRUE(next(2900ms).is_null());
    auto message = next(3s);
    EXPECT_EQ(message["text"], "2 boards lost, all behind host vm (desk, lamp)");
    // The receiver may have got it all the same: so it is told that one of them is back.
    notices_.back("lamp", moment(4s));
    notices_.failed(at(4s));
    message = next(6s);
    EXPECT_EQ(message["lost"]["count"], 1);
    EXPECT_EQ(message["back"]["boards"][0]["board"], "lamp");
    Duration now = 6s;
    for (const Duration wait : {4s, 8s, 16s, 32s, 60s, 60s}) {
        notices_.failed(at(now));
        EXPECT_TRUE(next(now + wait - 1ms).is_null());
        now += wait;
        ASSERT_FALSE(next(now).is_null()) << std::chrono::duration_cast<std::chrono::seconds>(wait).count();
    }
    notices_.delivered(at(now));
    lost("shed", now + 20s);
    EXPECT_FALSE(next(now + 21s).is_null()) << "delivered again: no long pause any more";
}

TEST_F(LossNoticesTest, MoreThanAreKept_AreCounted) {
    for (std::size_t board = 0; board < LossNotices::kMaxKept + 7; ++board)
        lost("b" + std::to_string(board), 0s);
    auto message = next(1s);
    EXPECT_EQ(message["lost"]["count"], LossNotices::kMaxKept + 7);
    EXPECT_THAT(message["text"].get<std::string>(),
                HasSubstr("100,007 boards lost: 100,000 behind host vm, 7 elsewhere"));
    notices_.failed(at(1s));
    EXPECT_EQ(delivered(5s)["lost"]["count"], LossNotices::kMaxKept + 7);
    lost("one more", 20s);
    EXPECT_EQ(delivered(21s)["text"], "1 board lost");
}

TEST_F(LossNoticesTest, ReceiverThatWantsAPause_GetsIt) {
    lost("b1", 0s);
    ASSERT_TRUE(notices_.next(moment(1s)));
    notices_.failed(at(1s), 30s);
    EXPECT_FALSE(notices_.next(moment(30s)));
    EXPECT_TRUE(notices_.next(moment(31s)));
}

TEST(WebhookAddress, IsTakenApart_AndAFaultTellsNoSecret) {
    const auto address = parse_webhook("https://hooks.example/services/T1/B2/?key=a%20b#top");
    ASSERT_TRUE(address) << address.error();
    EXPECT_EQ(address->server.text(), "https://hooks.example");
    EXPECT_EQ(address->target, "/services/T1/B2/?key=a%20b");
    EXPECT_EQ(parse_webhook("http://[::1]:8080")->target, "/");
    EXPECT_EQ(parse_webhook("http://pi.local?x=1")->target, "/?x=1");
    const auto with_user = parse_webhook("https://ann:p%40ss@pi.local:8443/topic?x=a@b");
    ASSERT_TRUE(with_user) << with_user.error();
    EXPECT_EQ(with_user->user, "ann:p@ss");
    EXPECT_EQ(with_user->server.text(), "https://pi.local:8443");
    EXPECT_EQ(with_user->target, "/topic?x=a@b");
    EXPECT_EQ(parse_webhook("http://pi.local#top")->target, "/");
    for (const char* wrong : {"", "pi.local/hook", "ftp://pi.local", "http://", "http://secret@pi.local/",
                              "http://a:secret%x@pi/", "http://a:secret@pi:99999/", "http://pi/a secret"}) {
        const auto refused = parse_webhook(wrong);
        ASSERT_FALSE(refused) << wrong;
        EXPECT_THAT(refused.error(), ::testing::Not(HasSubstr("secret"))) << wrong;
    }
}

}  // namespace loss_notices_test
}  // namespace asip::registry
