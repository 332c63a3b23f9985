// SPDX-License-Identifier: Apache-2.0
#include "gateway/stream/channel.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "clock.hpp"
#include "gateway/stream/value_feed.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

class ChannelTest : public testing::Test {
  protected:
    std::unique_ptr<StreamChannel> open(std::size_t max_subscriptions = 4) {
        StreamChannel::Dependencies dependencies;
        dependencies.now = [] { return at(0ms); };
        dependencies.subscribe = [this](const json& request) -> Expected<std::unique_ptr<Feed>> {
            if (!request["subscribe"].is_string()) return fail("subscribe: must be a string");
            return std::make_unique<ValueFeed>(values_, ValueFeed::Options{.board = "uno1",
                                                                           .service = request["subscribe"],
                                                                           .max_hz = 0,
                                                                           .after = {},
                                                                           .after_each = {},
                                                                           .allowed = {}});
        };
        dependencies.command = [this](const json& request, std::function<void(std::string)> answer) {
            commands_.push_back(request.dump());
            answer_ = std::move(answer);
        };
        dependencies.max_subscriptions = max_subscriptions;
        dependencies.part = budget_.part("test");
        return std::make_unique<StreamChannel>(streams_, std::move(dependencies), Principal{}, "test");
    }
    static std::vector<std::string> read(StreamChannel& channel) {
        std::vector<std::string> all;
        for (std::string message; channel.take(message); message.clear())
            all.push_back(message);
        return all;
    }

    Budget budget_{100'000};
    Values values_{"e1"};
    Streams streams_{10};
    std::vector<std::string> commands_;
    std::function<void(std::string)> answer_;
};

TEST_F(ChannelTest, Subscribe_OkThenSnapshotThenValuesWithTheRef) {
    auto channel = open();
    values_.value("uno1", "a", "1", false, at(0ms));
    EXPECT_TRUE(channel->received(R"({"subscribe":"a","ref":"x"})"));
    EXPECT_THAT(
        read(*channel),
        ElementsAre(
            R"({"ref":"x","ok":true})",
            R"({"ref":"x","event":"value","board":"uno1","service":"a","at":"2023-11-14T22:13:20.000Z","value":1,"age":0.000})",
            R"({"ref":"x","event":"snapshot-end","place":"e1-1"})"));
    values_.value("uno1", "a", "2", false, at(0ms));
    EXPECT_THAT(
        read(*channel),
        ElementsAre(
            R"({"ref":"x","event":"value","place":"e1-2","board":"uno1","service":"a","at":"2023-11-14T22:13:20.000Z","value":2})"));
}

TEST_F(ChannelTest, NumberLongerThanADouble_ComesBackAsItWasSent) {
    auto channel = open();
    channel->received(R"({"subscribe":"a","ref":12345678901234567890123})");
    EXPECT_THAT(read(*channel), testing::Contains(R"({"ref":12345678901234567890123,"ok":true})"));
    channel->received(R"({"unsubscribe":12345678901234567890124})");
    EXPECT_THAT(read(*channel), ElementsAre(HasSubstr(R"("ref":12345678901234567890124,"error")")));
    channel->received(R"({"unsubscribe":12345678901234567890123})");
    EXPECT_THAT(read(*channel), ElementsAre(R"({"ref":12345678901234567890123,"ok":true})"));
    channel->received(R"({"command":"uno1/a","write":[1],"id":12345678901234567890123})");
    EXPECT_THAT(commands_, ElementsAre(HasSubstr(R"("id":"12345678901234567890123")")));
    channel->received(R"({"subscribe":"a","ref":1)" + std::string(100, '0') + ".5}");
    EXPECT_THAT(read(*channel), ElementsAre(HasSubstr("at most 64 bytes")));
}

TEST_F(ChannelTest, SubscriptionWithMuch_DoesNotKeepAnotherWaiting) {
    auto channel = open();
    channel->received(R"({"subscribe":"a","ref":1})");
    channel->received(R"({"subscribe":"b","ref":2})");
    read(*channel);
    for (int i = 0; i < 50; ++i)
        values_.value("uno1", "a", std::to_string(i), false, at(0ms));
    values_.value("uno1", "b", "7", false, at(0ms));
    const auto all = read(*channel);
    ASSERT_EQ(all.size(), 51u);
    EXPECT_THAT(all[0] + all[1], HasSubstr("\"ref\":2"));
}

TEST_F(ChannelTest, Unsubscribed_NothingMoreComes) {
    auto channel = open();
    channel->received(R"({"subscribe":"a","ref":1})");
    channel->received(R"({"unsubscribe":1})");
    read(*channel);
    values_.value("uno1", "a", "1", false, at(0ms));
    EXPECT_THAT(read(*channel), ElementsAre());
}

TEST_F(ChannelTest, CommandsAnswer_ComesBackAlsoAfterTheChannelIsGone) {
    auto channel = open();
    channel->received(R"({"command":"uno1/servo","write":[0,90],"id":"7"})");
    answer_(R"({"id":"7","status":"ok"})");
    EXPECT_THAT(read(*channel), ElementsAre(R"({"id":"7","status":"ok"})"));
    const auto late = answer_;
    channel.reset();
    late("{}");
}

class WrongMessage : public ChannelTest, public testing::WithParamInterface<const char*> {};

TEST_P(WrongMessage, IsReportedAndTheNextGoodOneWorks) {
    auto channel = open();
    EXPECT_TRUE(channel->received(GetParam()));
    const auto answers = read(*channel);
    ASSERT_EQ(answers.size(), 1u);
    EXPECT_THAT(answers[0], HasSubstr("\"error\":"));
    channel->received(R"({"subscribe":"a","ref":1})");
    EXPECT_EQ(read(*channel).front(), R"({"ref":1,"ok":true})");
}

INSTANTIATE_TEST_SUITE_P(Channel, WrongMessage,
                         testing::Values("", "nonsense", "[]", "7", "{}", R"({"subscribe":"a"})",
                                         R"({"subscribe":"a","ref":{}})", R"({"subscribe":7,"ref":1})",
                                         R"({"subscribe":"a","unsubscribe":1,"ref":1})",
                                         R"({"unsubscribe":9})", R"({"hello":1})"));

TEST_F(ChannelTest, TooManySubscriptions_AreRefusedAndTheOthersLive) {
    auto channel = open(2);
    for (int ref = 1; ref <= 3; ++ref)
        channel->received(R"({"subscribe":"a","ref":)" + std::to_string(ref) + "}");
    std::string all;
    for (const auto& text : read(*channel))
        all += text;
    EXPECT_THAT(all, HasSubstr(R"({"ref":3,"error":"too many subscriptions on this connection"})"));
    values_.value("uno1", "a", "1", false, at(0ms));
    EXPECT_EQ(read(*channel).size(), 2u);
}

TEST_F(ChannelTest, OnlyNonsense_EndsTheConnection) {
    auto channel = open();
    bool goes_on = true;
    for (int i = 0; i < StreamChannel::kMaxFaults && goes_on; ++i) {
        goes_on = channel->received("nonsense");
        read(*channel);
    }
    EXPECT_FALSE(goes_on);
}

TEST_F(ChannelTest, AsksAndNeverReads_IsClosed) {
    auto channel = open();
    for (int i = 0; i < 50 && channel->close_code() == 0; ++i) {
        channel->received(R"({"unsubscribe":1})");
        read(*channel);
    }
    EXPECT_EQ(channel->close_code(), 0) << "it reads";
    for (std::size_t i = 0; i <= 100'000 / StreamChannel::kBytesOfAnswer; ++i)
        channel->received(R"({"unsubscribe":1})");
    EXPECT_EQ(channel->close_code(), 1008);
    EXPECT_LE(budget_.bytes_of("test"), 100'000u);
}

TEST_F(ChannelTest, Gone_ItsPlaceIsFree) {
    Streams streams(1);
    {
        StreamChannel channel(streams, {}, Principal{}, "one");
        EXPECT_FALSE(streams.has_room("one"));
        EXPECT_TRUE(streams.has_room("other"));
    }
    EXPECT_TRUE(streams.has_room("one"));
}

}  // namespace
}  // namespace asip::gateway
