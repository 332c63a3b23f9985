#include "asip/bus/requester.hpp"

#include <gmock/gmock.h>

#include <optional>
#include <vector>

namespace asip::bus {
namespace {

using testing::ElementsAre;

mqtt::Message message(std::string topic, std::string payload, std::string correlation = {}) {
    mqtt::Message made;
    made.topic = std::move(topic);
    made.payload = std::move(payload);
    made.correlation = std::move(correlation);
    return made;
}

class RequesterTest : public testing::Test {
  protected:
    Requester::Request ask(std::string payload, bool v5, const std::string& name) {
        sent = message("asip/uno1/servo/in", std::move(payload));
        return requester.ask(sent, v5, [this, name](const mqtt::Message& reply) {
            heard.push_back(name + ":" + reply.payload);
        });
    }
    Requester requester{"me", "asip/reply/me"};
    mqtt::Message sent;
    std::vector<std::string> heard;
};

TEST_F(RequesterTest, OnVersion5_AnswersAreFoundByCorrelation) {
    const auto a = ask("W,0,90", true, "a");
    EXPECT_EQ(sent.payload, "W,0,90");
    EXPECT_EQ(sent.response_topic, "asip/reply/me");
    const auto id_of_a = sent.correlation;
    const auto b = ask("W,0,91", true, "b");
    EXPECT_NE(sent.correlation, id_of_a);
    EXPECT_TRUE(requester.take(message("asip/reply/me", "2", sent.correlation)));
    EXPECT_TRUE(requester.take(message("asip/reply/me", "1", id_of_a)));
    EXPECT_TRUE(requester.take(message("asip/reply/me", "?", "stranger")));
    EXPECT_FALSE(requester.take(message("asip/reply/you", "x", id_of_a)));
    EXPECT_THAT(heard, ElementsAre("b:2", "a:1"));
}

TEST_F(RequesterTest, OnVersion311_RequestAndAnswerCarryTheIdInTheirText) {
    const auto a = ask(R"({"write":[0,90]})", false, "a");
    EXPECT_EQ(sent.payload, R"({"id":"me-1","reply_to":"asip/reply/me","write":[0,90]})");
    EXPECT_TRUE(sent.response_topic.empty());
    const auto b = ask("W,0,90", false, "b");
    EXPECT_EQ(sent.payload, R"({"id":"me-2","raw":"W,0,90","reply_to":"asip/reply/me"})");
    requester.take(message("asip/reply/me", R"({"status":"ok","id":"me-2"})"));
    requester.take(message("asip/reply/me", R"({"id":7})"));
    requester.take(message("asip/reply/me", "nonsense"));
    requester.take(message("asip/reply/me", R"({"nested":{"id":"me-1"}})"));
    EXPECT_THAT(heard, ElementsAre(R"(b:{"status":"ok","id":"me-2"})"));
}

TEST_F(RequesterTest, RequestEnded_ItsAnswerIsIgnored) {
    auto a = ask("x", true, "a");
    const auto correlation = sent.correlation;
    a.reset();
    EXPECT_TRUE(requester.take(message("asip/reply/me", "late", correlation)));
    EXPECT_TRUE(heard.empty());
}

TEST_F(RequesterTest, RequestEndsInsideItsOwnCallback_IsHarmless) {
    std::optional<Requester::Request> own;
    std::string seen;
    sent = message("t", "x");
    own = requester.ask(sent, true, [&, text = std::string(100, 'y')](const mqtt::Message&) {
        own.reset();
        seen = text;
    });
    requester.take(message("asip/reply/me", "1", sent.correlation));
    EXPECT_EQ(seen, std::string(100, 'y'));
}

TEST(Request, OutlivesItsRequester_IsHarmless) {
    Requester::Request left;
    {
        Requester requester("me", "r");
        auto sent = message("t", "x");
        left = requester.ask(sent, true, [](const mqtt::Message&) { FAIL(); });
    }
    EXPECT_EQ(left.id(), "me-1");
    left.reset();
    EXPECT_EQ(left.id(), "");
}

}  // namespace
}  // namespace asip::bus
