// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/broker_list.hpp"

#include <gtest/gtest.h>

namespace asip::mqtt {
namespace {

using namespace std::chrono_literals;
using Kind = ConnectionFailure::Kind;

class BrokerListTest : public ::testing::Test {
  protected:
    BrokerList list_of(int count, Version version = Version::kBest) {
        std::vector<BrokerAddress> brokers;
        for (int i = 0; i < count; ++i)
            brokers.push_back({"broker" + std::to_string(i), 1883, false});
        return {brokers, version, Backoff(100ms, 2s)};
    }
    static ConnectionEnd ended(const BrokerList& list, Kind kind) {
        return {ConnectionFailure{kind, list.current()}};
    }
    static ConnectionEnd unanswered(const BrokerList& list) {
        auto end = ended(list, Kind::kNoAnswer);
        end.closed_unanswered = true;
        return end;
    }

    Random random_ = [] { return ~std::uint64_t{0}; };  // the longest wait
};

TEST_F(BrokerListTest, WholeListFailed_ThenThereIsAPauseThatGrows) {
    auto list = list_of(2);
    EXPECT_EQ(list.failed(ended(list, Kind::kUnreachable), true, random_).wait, 0s);
    EXPECT_EQ(list.current().host, "broker1");
    const auto first = list.failed(ended(list, Kind::kUnreachable), true, random_).wait;
    EXPECT_EQ(list.current().host, "broker0");
    EXPECT_GT(first, 99ms);
    list.failed(ended(list, Kind::kUnreachable), true, random_);
    EXPECT_GT(list.failed(ended(list, Kind::kUnreachable), true, random_).wait, first);
}

TEST_F(BrokerListTest, SilenceForMqtt5_IsTriedWithout5AndBackWhereThatIsNoBetter) {
    auto list = list_of(1);
    for (int round = 0; round < 3; ++round) {
        EXPECT_TRUE(list.with_v5()) << round;
        EXPECT_TRUE(list.failed(ended(list, Kind::kNoAnswer), true, random_).failure);
        EXPECT_FALSE(list.with_v5()) << round;
        list.failed(ended(list, Kind::kNoAnswer), false, random_);
    }
    list.failed(ended(list, Kind::kNoAnswer), true, random_);
    list.accepted();
    EXPECT_TRUE(list.with_v5()) << "once may be chance";
}

TEST_F(BrokerListTest, SilenceOfOneOfAList_TheNextOneIsTriedAtOnce) {
    auto list = list_of(2);
    list.failed(ended(list, Kind::kNoAnswer), true, random_);
    EXPECT_EQ(list.current().host, "broker1");
}

TEST_F(BrokerListTest, SilenceOfABrokerThatTook5_IsNoSuspicion) {
    auto list = list_of(1);
    list.accepted();
    for (int attempt = 0; attempt < 5; ++attempt)
        list.failed(ended(list, Kind::kNoAnswer), true, random_);
    EXPECT_TRUE(list.with_v5());
}

TEST_F(BrokerListTest, VersionRefused_SameBrokerIsTriedWithout5AndNothingIsReported) {
    auto list = list_of(2);
    EXPECT_TRUE(list.with_v5());
    auto end = ended(list, Kind::kRefused);
    end.version_refused = true;
    EXPECT_FALSE(list.failed(end, true, random_).failure);
    EXPECT_EQ(list.current().host, "broker0");
    EXPECT_FALSE(list.with_v5());
}

TEST_F(BrokerListTest, VersionRefusedWhereNoOtherIsAllowed_IsReported) {
    auto list = list_of(1, Version::kV5);
    auto end = ended(list, Kind::kRefused);
    end.version_refused = true;
    EXPECT_TRUE(list.failed(end, true, random_).failure);
    EXPECT_TRUE(list.with_v5());
}

TEST_F(BrokerListTest, ClosedUnansweredTwice_TriesWithout5AndReturnsTo5WhenThatFailsToo) {
    auto list = list_of(2);
    list.failed(unanswered(list), true, random_);
    EXPECT_EQ(list.current().host, "broker0") << "suspected: the same broker again";
    EXPECT_TRUE(list.with_v5());
    list.failed(unanswered(list), true, random_);
    EXPECT_FALSE(list.with_v5());
    list.failed(unanswered(list), false, random_);
    EXPECT_EQ(list.current().host, "broker1") << "the suspicion was wrong";
}

TEST_F(BrokerListTest, TlsBrokerThatClosesUnansweredThreeTimes_IsReportedAsTls) {
    BrokerList list({{"broker", 8883, true}}, Version::kV5, Backoff(100ms, 2s));
    EXPECT_EQ(list.failed(unanswered(list), true, random_).failure->kind, Kind::kNoAnswer);
    EXPECT_EQ(list.failed(unanswered(list), true, random_).failure->kind, Kind::kNoAnswer);
    EXPECT_EQ(list.failed(unanswered(list), true, random_).failure->kind, Kind::kTls);
}

TEST_F(BrokerListTest, EveryBrokerFailedFatally_IsHopelessUnlessOneEverAccepted) {
    auto list = list_of(2);
    EXPECT_FALSE(list.failed(ended(list, Kind::kBadCredentials), true, random_).failure->hopeless);
    EXPECT_TRUE(list.failed(ended(list, Kind::kBadCredentials), true, random_).failure->hopeless);
    list.accepted();
    list.lost(ended(list, Kind::kClosed), 1s, random_);
    EXPECT_FALSE(list.failed(ended(list, Kind::kBadCredentials), true, random_).failure->hopeless);
}

TEST_F(BrokerListTest, LostConnection_ReturnsToTheSameBrokerUnlessItStalled) {
    auto list = list_of(2);
    list.accepted();
    list.lost(ended(list, Kind::kClosed), 1min, random_);
    EXPECT_EQ(list.current().host, "broker0");
    list.accepted();
    list.lost(ended(list, Kind::kStalled), 1min, random_);
    EXPECT_EQ(list.current().host, "broker1");
}

TEST_F(BrokerListTest, ConnectionClosedAsSoonAsAccepted_IsTriedThreeTimesThenTheNextIs) {
    auto list = list_of(2);
    for (const char* next : {"broker0", "broker0", "broker1", "broker1", "broker1", "broker0"}) {
        list.accepted();
        EXPECT_GT(list.lost(ended(list, Kind::kClosed), 1s, random_).wait, 0s);
        EXPECT_EQ(list.current().host, next);
    }
    for (int i = 0; i < 3; ++i) {
        list.lost(ended(list, Kind::kTakenOver), 1s, random_);
        EXPECT_EQ(list.current().host, "broker0") << "by another one with our identifier";
    }
    for (int i = 0; i < 3; ++i) {
        list.lost(ended(list, Kind::kClosed), 1s, random_);
        list.lost(ended(list, Kind::kClosed), 1s, random_);
        list.lost(ended(list, Kind::kClosed), 1min, random_);
        EXPECT_EQ(list.current().host, "broker0");
    }
    list.lost(ended(list, Kind::kClosed), 1s, random_);
    list.failed(ended(list, Kind::kUnreachable), true, random_);
    for (int i = 0; i < 2; ++i) {
        list.lost(ended(list, Kind::kClosed), 1s, random_);
        EXPECT_EQ(list.current().host, "broker1") << "which has done so for the first time";
    }
}

TEST_F(BrokerListTest, GoodConnectionLost_WholeListIsTriedAtOnce) {
    auto list = list_of(3);
    list.accepted();
    EXPECT_EQ(list.lost(ended(list, Kind::kClosed), 1min, random_).wait, 0s);
    for (const char* next : {"broker1", "broker2"}) {
        EXPECT_EQ(list.failed(ended(list, Kind::kUnreachable), true, random_).wait, 0s);
        EXPECT_EQ(list.current().host, next);
    }
    EXPECT_GT(list.failed(ended(list, Kind::kUnreachable), true, random_).wait, 99ms);
}

TEST_F(BrokerListTest, ConnectionThatHeldShortly_DoesNotShortenThePause) {
    auto list = list_of(1);
    Duration wait{};
    for (int i = 0; i < 6; ++i) {
        list.accepted();
        wait = list.lost(ended(list, Kind::kClosed), 1s, random_).wait;
    }
    EXPECT_GT(wait, 1900ms);
    list.accepted();
    EXPECT_LT(list.lost(ended(list, Kind::kClosed), 5s, random_).wait, 101ms);
}

}  // namespace
}  // namespace asip::mqtt
