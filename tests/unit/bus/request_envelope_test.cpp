#include "asip/bus/request_envelope.hpp"

#include <gtest/gtest.h>

namespace asip::bus {
namespace {

mqtt::Message request(std::string payload) {
    mqtt::Message message;
    message.topic = "asip/uno1/servo/in";
    message.payload = std::move(payload);
    return message;
}

TEST(Envelope, JsonWithReplyToAndId_IsTakenApart) {
    const auto envelope = open_envelope(request(R"( {"write":[0,90],"reply_to":"me/answers","id":"7"})"));
    ASSERT_TRUE(envelope) << envelope.error().error;
    EXPECT_EQ(envelope->form, RequestEnvelope::Form::kJson);
    EXPECT_EQ(envelope->body, R"({"write":[0,90]})");
    EXPECT_EQ(envelope->reply, (ReplyTo{"me/answers", "", "7"}));
}

TEST(Envelope, ResponseTopicOfMqtt5_WinsOverReplyTo) {
    auto message = request(R"({"write":[0,90],"reply_to":"other","id":7})");
    message.response_topic = "mine";
    message.correlation = std::string("\0\x01", 2);
    const auto envelope = open_envelope(message);
    ASSERT_TRUE(envelope);
    EXPECT_EQ(envelope->reply, (ReplyTo{"mine", std::string("\0\x01", 2), "7"}));
}

TEST(Envelope, AsipText_IsPassedAsItCame) {
    auto message = request("W,0,90\n");
    message.response_topic = "mine";
    const auto envelope = open_envelope(message);
    ASSERT_TRUE(envelope);
    EXPECT_EQ(envelope->form, RequestEnvelope::Form::kRaw);
    EXPECT_EQ(envelope->body, "W,0,90\n");
    EXPECT_EQ(envelope->reply.topic, "mine");
}

TEST(Envelope, RawMember_IsAsipText) {
    const auto envelope = open_envelope(request(R"({"raw":"#,?","reply_to":"me","id":"1"})"));
    ASSERT_TRUE(envelope);
    EXPECT_EQ(envelope->form, RequestEnvelope::Form::kRaw);
    EXPECT_EQ(envelope->body, "#,?");
    EXPECT_EQ(envelope->reply.topic, "me");
}

TEST(Envelope, Empty_IsRawAndEmpty) {
    const auto envelope = open_envelope(request(""));
    ASSERT_TRUE(envelope);
    EXPECT_EQ(envelope->body, "");
    EXPECT_FALSE(envelope->reply.wanted());
}

TEST(Envelope, Unusable_IsRefusedAndTheRequesterIsStillKnown) {
    const std::string deep = R"({"x":)" + std::string(40, '[') + std::string(40, ']') + "}";
    for (const auto& payload : {std::string("{"), std::string("{]"), deep, std::string(R"({"id":{}})"),
                                std::string(R"({"id":null})"), R"({"id":")" + std::string(200, 'x') + "\"}",
                                std::string(R"({"raw":1})"), std::string(R"({"reply_to":"a/#"})"),
                                std::string(R"({"reply_to":""})"), std::string(R"({"reply_to":7})"),
                                std::string(R"({"reply_to":"$SYS/x"})"), std::string("{\"x\":\"\xff\"}"),
                                "{" + std::string(kMaxRequestBytes, ' ') + "}", std::string(1 << 20, '{')}) {
        auto message = request(payload);
        message.response_topic = "mine";
        const auto envelope = open_envelope(message);
        ASSERT_FALSE(envelope) << payload.substr(0, 60);
        EXPECT_EQ(envelope.error().reply.topic, "mine");
        EXPECT_FALSE(envelope.error().error.empty());
    }
}

TEST(Envelope, ResponseTopicWithWildcard_IsRefusedWithoutAnswer) {
    for (const char* topic : {"a/+", "#", "$share/x", "a\nb"}) {
        auto message = request("W,0,90");
        message.response_topic = topic;
        const auto envelope = open_envelope(message);
        ASSERT_FALSE(envelope);
        EXPECT_FALSE(envelope.error().reply.wanted());
    }
    auto message = request("W,0,90");
    message.response_topic = "ok";
    message.correlation = std::string(kMaxCorrelationBytes + 1, 'x');
    EXPECT_FALSE(open_envelope(message));
}

}  // namespace
}  // namespace asip::bus
