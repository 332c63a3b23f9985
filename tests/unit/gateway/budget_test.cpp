// SPDX-License-Identifier: Apache-2.0
#include "gateway/stream/budget.hpp"

#include "api_bench.hpp"
#include "gateway/auth/secret.hpp"
#include "gateway/stream/value_feed.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(Budget, Parts_OfOneClientShareItsBound) {
    Budget budget(100);
    auto one = budget.part("anna");
    auto two = budget.part("anna");
    auto other = budget.part("bert");
    EXPECT_TRUE(one.set(60));
    EXPECT_FALSE(two.set(41));
    EXPECT_EQ(two.bytes(), 0u) << "nothing of what did not fit";
    EXPECT_TRUE(two.set(40));
    EXPECT_TRUE(other.set(100)) << "another client's is another one";
    EXPECT_FALSE(one.add(1));
    EXPECT_TRUE(one.set(10)) << "less always fits";
    EXPECT_TRUE(two.add(50));
    EXPECT_EQ(budget.bytes_of("anna"), 100u);
}

TEST(Budget, PartIsGone_ItsBytesAreGivenBack) {
    Budget budget(100);
    {
        auto part = budget.part("anna");
        ASSERT_TRUE(part.set(100));
        auto moved = std::move(part);
        EXPECT_EQ(budget.bytes_of("anna"), 100u);
        moved = budget.part("anna");
        EXPECT_EQ(budget.bytes_of("anna"), 0u);
        ASSERT_TRUE(moved.set(7));
    }
    EXPECT_EQ(budget.bytes_of("anna"), 0u);
    EXPECT_EQ(budget.clients(), 1u);
    budget.expire();
    EXPECT_EQ(budget.clients(), 0u) << "who takes nothing is forgotten";
}

TEST(Budget, HugeSizes_DoNotWrapAround) {
    Budget budget(100);
    auto part = budget.part("anna");
    ASSERT_TRUE(part.set(50));
    EXPECT_FALSE(part.set(SIZE_MAX));
    EXPECT_FALSE(part.set(SIZE_MAX - 10));
    EXPECT_EQ(part.bytes(), 50u);
}

TEST(Budget, PartOfNobody_AlwaysFitsAndOutlivesTheBudget) {
    Budget::Part nobodys;
    EXPECT_TRUE(nobodys.set(SIZE_MAX));
    Budget::Part part;
    {
        Budget budget(10);
        part = budget.part("anna");
        ASSERT_TRUE(part.set(10));
    }
    EXPECT_FALSE(part.set(11));
    EXPECT_TRUE(part.set(1));
}

/// A gateway with many services, whose viewer asks for all of them again and again.
class ClientBytes : public ApiTest {
  protected:
    ClientBytes() : ApiTest(Role::kNone) {
        gateway_->gate().set_tokens(
            *Tokens::parse("viewer eve " + hash_of("eve") + "\noperator anna " + hash_of("anna") + "\n"));
        announce();
        for (int i = 0; i < 1000; ++i) {
            const auto board = "b" + std::to_string(i);
            bus("asip/servicebus/" + board + "/$state", "online");
            announce(board);
            bus("asip/" + board + "/distance/out", R"({"distance":[1]})");
        }
    }
    std::shared_ptr<Captured> as(const std::string& token, const std::string& method,
                                 const std::string& target, const std::string& body = {}) {
        return ask(method, target, body, {{"authorization", "Bearer " + token}});
    }
    std::shared_ptr<Captured> socket(const std::string& token) {
        return ask("GET", "/api/stream", {},
                   {{"authorization", "Bearer " + token},
                    {"upgrade", "websocket"},
                    {"connection", "Upgrade"},
                    {"sec-websocket-version", "13"},
                    {"sec-websocket-key", "dGhlIHNhbXBsZSBub25jZQ=="}});
    }
    /// All that `client` may have kept is taken, but for a megabyte.
    Budget::Part most_of(const std::string& client) {
        auto part = gateway_->budget().part(client);
        EXPECT_TRUE(part.set(GatewayOptions{}.client_bytes - (std::size_t{1} << 20)));
        return part;
    }
    std::size_t kept(const std::string& client) { return gateway_->budget().bytes_of(client); }
};

TEST_F(ClientBytes, SubscriptionsOverManySockets_HaveOneBoundAndOthersTheirs) {
    std::vector<std::shared_ptr<Captured>> sockets;
    std::size_t granted = 0;
    std::string refused;
    for (int i = 0; i < 64; ++i) {
        sockets.push_back(socket("eve"));
        if (!sockets.back()->channel) continue;
        for (int ref = 0; ref < 256; ++ref) {
            sockets.back()->channel->received(R"({"subscribe":"*/*","ref":)" + std::to_string(ref) + "}");
            std::string text;
            sockets.back()->channel->take(text);
            granted += text.find("\"ok\"") != std::string::npos;
            if (text.find("error") != std::string::npos) refused = text;
        }
    }
    EXPECT_GT(granted, 100u) << "more than anybody needs";
    EXPECT_THAT(refused, HasSubstr("too much would be kept for this client"));
    EXPECT_LE(kept("eve"), GatewayOptions{}.client_bytes);
    EXPECT_LT(granted * 1000 * ValueFeed::kBytesOfService, GatewayOptions{}.client_bytes);
    const auto anna = socket("anna");
    ASSERT_TRUE(anna->channel);
    anna->channel->received(R"({"subscribe":"*/*","ref":1})");
    std::string text;
    anna->channel->take(text);
    EXPECT_EQ(text, R"({"ref":1,"ok":true})");
    sockets.clear();
    EXPECT_EQ(kept("eve"), 0u);
}

TEST_F(ClientBytes, ServiceThatAppears_IsCountedToThoseWhoMatchItAndEndsWhatIsTooMuch) {
    const auto one = socket("eve");
    one->channel->received(R"({"subscribe":"*/*","ref":1})");
    std::string text;
    while (one->channel->take(text))
        text.clear();
    const auto before = kept("eve");
    bus("asip/b1/servo/out", R"({"servo":1})");
    EXPECT_GE(kept("eve"), before + ValueFeed::kBytesOfService);
}

TEST_F(ClientBytes, SnapshotsThatAreNotRead_AreCounted) {
    const auto taken = most_of("eve");
    std::vector<std::shared_ptr<Captured>> sockets;
    for (int i = 0; i < 4; ++i) {
        sockets.push_back(socket("eve"));
        if (!sockets.back()->channel) continue;
        for (int ref = 0; ref < 256; ++ref) {
            sockets.back()->channel->received(R"({"subscribe":"$catalogue","ref":)" + std::to_string(ref) +
                                              "}");
            std::string text;
            sockets.back()->channel->take(text);  // its answer
            sockets.back()->channel->take(text);  // and the first board: a page is read
        }
    }
    EXPECT_LE(kept("eve"), GatewayOptions{}.client_bytes);
    EXPECT_GT(kept("eve"), taken.bytes() + (std::size_t{1} << 19)) << "what waits is counted";
}

TEST_F(ClientBytes, AnswersThatAreNotRead_EndTheConnection) {
    const auto one = socket("eve");
    const auto taken = most_of("eve");
    int sent = 0;
    while (one->channel->close_code() == 0 && ++sent < 2'000'000)
        one->channel->received(R"({"unsubscribe":1})");
    EXPECT_EQ(one->channel->close_code(), 1008);
    EXPECT_LE(kept("eve"), GatewayOptions{}.client_bytes);
}

TEST_F(ClientBytes, ResponsesThatAreTakenSlowly_HaveABound) {
    const auto taken = most_of("eve");
    std::vector<std::shared_ptr<Captured>> slow;
    int refused = 0;
    for (int i = 0; i < 2000 && refused == 0; ++i) {
        slow.push_back(as("eve", "GET", "/api/boards?limit=1000"));
        refused += slow.back()->status() == 429;
    }
    EXPECT_EQ(refused, 1);
    EXPECT_THAT(slow.back()->detail(), HasSubstr("too much waits to be read"));
    EXPECT_EQ(as("anna", "GET", "/api/boards?limit=1000")->status(), 200);
    slow.clear();
    EXPECT_EQ(as("eve", "GET", "/api/boards?limit=1000")->status(), 200) << "once they are read";
}

TEST_F(ClientBytes, CommandsThatAreRemembered_AreCountedForAMinute) {
    const auto before = kept("anna");
    as("anna", "POST", "/api/boards/uno1/services/servo/commands/write", "[0,90]");
    EXPECT_GT(kept("anna"), before);
    answer(R"({"status":"ok","proof":"fence"})");
    pass(59s);
    EXPECT_GT(kept("anna"), before);
    pass(2s);
    EXPECT_EQ(kept("anna"), before);
}

TEST_F(ClientBytes, WhoseBudgetIsUsedUp_CanStopAllTheSameAndNothingIsTakenForIt) {
    auto rest = gateway_->budget().part("anna");
    ASSERT_TRUE(rest.set(GatewayOptions{}.client_bytes));
    const std::string command = "/api/boards/uno1/services/servo/commands/write";
    EXPECT_EQ(as("anna", "POST", command, "[0,90]")->status(), 429);
    published_.clear();
    EXPECT_EQ(as("anna", "POST", "/api/stop", "{}")->status(), 0) << "sent, and waited for";
    EXPECT_EQ(published_.size(), 1001u);
    rest.set(0);
    EXPECT_EQ(kept("anna"), 0u);
    EXPECT_EQ(as("anna", "POST", command, "[0,90]")->status(), 0);
}

// ---- waits ----

TEST_F(ClientBytes, WaitsOfClientsThatAreGone_EndAndTheirPlacesComeBack) {
    const auto streams = [&] { return gateway_->streams().size(); };
    for (int i = 0; i < 2000; ++i) {
        auto closed = as("eve", "GET", "/api/boards/uno1/services/servo/value?wait=60");
        ASSERT_EQ(i < 64 ? closed->status() : 0, 0) << i;
        closed.reset();  // the connection is gone
        if (i % 64 == 63) pass(100ms);
    }
    pass(100ms);
    EXPECT_EQ(streams(), 0u);
    EXPECT_EQ(kept("eve"), 0u);
}

TEST_F(ClientBytes, WaitsBeyondTheLimitOfStreams_Are429) {
    std::vector<std::shared_ptr<Captured>> waiting;
    for (int i = 0; i < 64; ++i)
        waiting.push_back(as("eve", "GET", "/api/boards/uno1/services/servo/value?wait=60"));
    EXPECT_EQ(as("eve", "GET", "/api/boards/uno1/services/servo/value?wait=60")->status(), 429);
    EXPECT_EQ(as("eve", "GET", "/api/events")->status(), 429) << "a wait is a stream";
    EXPECT_EQ(as("anna", "GET", "/api/boards/uno1/services/servo/value?wait=60")->status(), 0);
    bus("asip/uno1/servo/out", R"({"servo":[1]})");
    for (const auto& each : waiting)
        EXPECT_EQ(each->status(), 200);
    EXPECT_EQ(as("eve", "GET", "/api/events")->status(), 200);
}

TEST_F(ClientBytes, RightTakenBack_ItsWaitsEnd) {
    const auto waiting = as("eve", "GET", "/api/boards/uno1/services/servo/value?wait=60");
    gateway_->gate().set_tokens(*Tokens::parse("operator anna " + hash_of("anna") + "\n"));
    pass(1s);
    pass(100ms);
    EXPECT_EQ(waiting->status(), 401);
}

TEST_F(ClientBytes, NameOfASession_HasABound) {
    for (const std::string& name : {std::string(65, 'x'), std::string(10'000, 'x')}) {
        EXPECT_EQ(
            ask("GET", "/api/commands/7", {}, {{"authorization", "Bearer anna"}, {"asip-session", name}})
                ->status(),
            400)
            << name;
    }
    EXPECT_EQ(as("anna", "GET", "/api/stream?session=" + std::string(65, 'x'))->status(), 426)
        << "no WebSocket was asked for";
}

}  // namespace
}  // namespace asip::gateway
