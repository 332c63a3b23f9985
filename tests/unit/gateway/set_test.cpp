// SPDX-License-Identifier: Apache-2.0
// What was set in a service, as agents say it, to clients that ask the gateway.
#include "api_bench.hpp"
#include "gateway/stream/value_feed.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;

class SetTest : public ApiTest {
  protected:
    SetTest() { announce(); }
    json value() { return get("/api/boards/uno1/services/servo/value")->body(); }
};

TEST_F(SetTest, Said_IsThereBesideTheValues) {
    EXPECT_FALSE(value().contains("set"));
    bus("asip/uno1/servo/set", R"({"write":{"0":90}})");
    bus("asip/uno1/servo/out", R"({"angle":[12]})");
    EXPECT_EQ(value()["set"], json::parse(R"({"write":{"0":90}})"));
    EXPECT_EQ(value()["events"].size(), 1u) << "it is no event";
    bus("asip/uno1/servo/set", "");
    EXPECT_FALSE(value().contains("set"));
}

TEST_F(SetTest, SaidAgain_IsNoNewPoint) {
    bus("asip/uno1/servo/set", R"({"write":{"0":90}})");
    const auto place = value()["place"];
    bus("asip/uno1/servo/set", R"({"write":{"0":90}})");
    EXPECT_EQ(value()["place"], place);
}

TEST_F(SetTest, Past_HasIt) {
    bus("asip/uno1/servo/set", R"({"write":{"0":90}})");
    bus("asip/uno1/servo/set", "");
    const auto items = get("/api/boards/uno1/services/servo/values")->body()["items"];
    ASSERT_EQ(items.size(), 2u);
    EXPECT_EQ(items[0]["set"], json::parse(R"({"write":{"0":90}})"));
    EXPECT_TRUE(items[1].contains("set") && items[1]["set"].is_null());
}

TEST_F(SetTest, OfNoBoard_IsDropped) {
    bus("asip/nobody/servo/set", R"({"write":{"0":90}})");
    EXPECT_EQ(gateway_->mirror().values().services(), 0u);
}

TEST_F(SetTest, BeforeItsBoardWhileTheRetainedCome_IsKept) {
    gateway_->disconnected();
    gateway_->subscribed();
    bus("asip/late/servo/set", R"({"write":{"0":1}})");
    announce("late");
    bus("asip/uno1/servo/set", R"({"write":{"0":2}})");
    settle();
    EXPECT_EQ(value()["set"], json::parse(R"({"write":{"0":2}})"));
}

TEST_F(SetTest, AheadOfTheAnswerToTheSubscriptions_IsKept) {
    gateway_->disconnected();
    bus("asip/uno1/servo/set", R"({"write":{"0":2}})");
    bus("asip/late/servo/set", R"({"write":{"0":1}})");
    gateway_->subscribed();
    announce("late");
    settle();
    EXPECT_EQ(value()["set"], json::parse(R"({"write":{"0":2}})"));
    EXPECT_EQ(get("/api/boards/late/services/servo/value")->body()["set"],
              json::parse(R"({"write":{"0":1}})"));
    gateway_->disconnected();
    bus("asip/late/servo/set", R"({"write":{"0":1}})");
    gateway_->disconnected();  // before all was subscribed to
    gateway_->subscribed();
    settle();
    EXPECT_FALSE(value().contains("set")) << "it was cleared meanwhile";
}

TEST_F(SetTest, ClearedWhileTheBrokerWasAway_IsNotKnown) {
    bus("asip/uno1/servo/set", R"({"write":{"0":90}})");
    gateway_->disconnected();
    gateway_->subscribed();
    settle();
    EXPECT_FALSE(value().contains("set"));
}

TEST_F(SetTest, Stream_BeginsWithItAndTellsTheNext) {
    bus("asip/uno1/servo/set", R"({"write":{"0":90}})");
    ValueFeed::Options options;
    options.board = "uno1";
    options.service = "servo";
    ValueFeed feed(gateway_->mirror().values(), std::move(options));
    StreamEvent event;
    std::vector<std::string> kinds;
    const auto read = [&] {
        while (feed.next(event, gateway_->now()))
            kinds.push_back(std::string(event.kind) + " " +
                            json::parse(event.data).value("value", json()).dump());
    };
    read();
    bus("asip/uno1/servo/set", "");
    read();
    EXPECT_EQ(kinds,
              (std::vector<std::string>{R"(set {"write":{"0":90}})", "snapshot-end null", "set null"}));
}

}  // namespace
}  // namespace asip::gateway
