// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/request_envelope.hpp"

#include <gtest/gtest.h>

#include "asip/bus/registry/query.hpp"
#include "asip/model/command_encoder.hpp"

namespace asip::bus {
namespace {

mqtt::Message request(std::string payload) {
    return mqtt::Message{.topic = "asip/uno1/servo/in", .payload = std::move(payload)};
}

TEST(Envelope, JsonWithReplyToAndId_IsTakenApart) {
    const auto envelope = open_envelope(request(R"( {"write":[0,90],"reply_to":"me/answers","id":"7"})"));
    ASSERT_TRUE(envelope) << envelope.error().error;
    EXPECT_EQ(envelope->form, RequestEnvelope::Form::kJson);
    EXPECT_EQ(envelope->object, nlohmann::json::parse(R"({"write":[0,90]})"));
    EXPECT_EQ(envelope->shown(), R"({"write":[0,90]})");
    EXPECT_EQ(envelope->reply, (ReplyTo{"me/answers", "", "7"}));
}

TEST(Envelope, DeadlineAndHold_AreTakenOutOfTheRequest) {
    const auto envelope = open_envelope(request(R"({"write":[0,90],"deadline_ms":50,"hold_ms":60000})"));
    ASSERT_TRUE(envelope);
    EXPECT_EQ(envelope->object, nlohmann::json::parse(R"({"write":[0,90]})"));
    EXPECT_EQ(envelope->deadline, std::chrono::milliseconds(50));
    EXPECT_EQ(envelope->hold, std::chrono::milliseconds(60000));
    for (const char* hold : {"49", "60001", "1.5", "\"500\"", "null", "true"}) {
        const auto bad = open_envelope(request(std::string(R"({"write":[0,90],"hold_ms":)") + hold + "}"));
        ASSERT_FALSE(bad) << hold;
        EXPECT_EQ(bad.error().error, "\"hold_ms\" must be a whole number from 50 to 60000");
    }
}

TEST(Envelope, ResponseTopicOfMqtt5_WinsOverReplyTo) {
    auto message = request(R"({"write":[0,90],"reply_to":"other","id":7})");
    message.response_topic = "mine";
    message.correlation = std::string("\0\x01", 2);
    const auto envelope = open_envelope(message);
    ASSERT_TRUE(envelope);
    EXPECT_EQ(envelope->reply, (ReplyTo{"mine", std::string("\0\x01", 2), "7", "", true}));
}

TEST(Envelope, AsipText_IsPassedAsItCame) {
    auto message = request("W,0,90\n");
    message.response_topic = "mine";
    const auto envelope = open_envelope(message);
    ASSERT_TRUE(envelope);
    EXPECT_EQ(envelope->form, RequestEnvelope::Form::kRaw);
    EXPECT_EQ(envelope->text, "W,0,90\n");
    EXPECT_EQ(envelope->reply.topic, "mine");
}

TEST(Envelope, RawMember_IsAsipText) {
    const auto envelope = open_envelope(request(R"({"raw":"#,?","reply_to":"me","id":"1"})"));
    ASSERT_TRUE(envelope);
    EXPECT_EQ(envelope->form, RequestEnvelope::Form::kRaw);
    EXPECT_EQ(envelope->text, "#,?");
    EXPECT_EQ(envelope->reply.topic, "me");
}

TEST(Envelope, MarkOfAnEditorBeforeTheText_IsNothing) {
    const auto marked = open_envelope(request("\xef\xbb\xbf{\"write\":[0,90],\"id\":\"7\"}"));
    ASSERT_TRUE(marked);
    EXPECT_EQ(marked->form, RequestEnvelope::Form::kJson);
    EXPECT_EQ(marked->reply.id, "7");
    EXPECT_EQ(open_envelope(request("\xef\xbb\xbfW,0,90"))->text, "W,0,90");
    EXPECT_EQ(open_envelope(request("\xef\xbb\xbf"))->text, "");
}

TEST(Envelope, IdThatIsALongNumber_ComesBackAsItWasWritten) {
    for (const char* id : {"12345678901234567890123", "18446744073709551616", "1.50", "1e3", "-0", "7"})
        EXPECT_EQ(open_envelope(request(std::string(R"({"write":[0,90],"id":)") + id + "}"))->reply.id,
                  id == std::string("-0") ? "0" : id);
    EXPECT_EQ(open_envelope(request(R"({"renew":12345678901234567890123})"))->object["renew"],
              "12345678901234567890123");
}

TEST(Envelope, Empty_IsRawAndEmpty) {
    const auto envelope = open_envelope(request(""));
    ASSERT_TRUE(envelope);
    EXPECT_EQ(envelope->text, "");
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

TEST(Envelope, WhoAsksAtTooGreatLength_IsCutBehindAWholeCharacter) {
    const std::string fits(kMaxByBytes, 'x');
    for (const auto& [by, kept] : {std::pair{fits, fits},
                                   {fits + "x", fits},
                                   {fits.substr(1) + "\u00e4", fits.substr(1)},
                                   {fits.substr(2) + "\u20ac", fits.substr(2)},
                                   {fits.substr(2) + "\u00e4x", fits.substr(2) + "\u00e4"}}) {
        const auto envelope = open_envelope(request(R"({"by":")" + by + R"(","reply_to":"mine"})"));
        ASSERT_TRUE(envelope) << by;
        EXPECT_EQ(envelope->reply.by, kept);
    }
}

TEST(Envelope, IdThatIsNone_RequesterNamedByReplyToIsStillKnown) {
    for (const auto& id : {std::string("true"), std::string("null"), std::string("[]"), std::string("{}"),
                           '"' + std::string(kMaxRequestIdBytes + 1, 'x') + '"'}) {
        const auto envelope =
            open_envelope(request(R"({"write":[0,90],"by":"anna","reply_to":"mine","id":)" + id + "}"));
        ASSERT_FALSE(envelope) << id;
        EXPECT_EQ(envelope.error().reply.topic, "mine") << id;
        EXPECT_EQ(envelope.error().reply.by, "anna") << id;
        EXPECT_EQ(envelope.error().reply.id, "") << id;
    }
}

TEST(Envelope, NumberTooLarge_RequesterIsKnownWhereverItStands) {
    for (const char* payload :
         {R"({"deadline_ms":1e400,"write":[13,1],"id":"7","by":"anna","reply_to":"mine"})",
          R"({"id":"7","by":"anna","reply_to":"mine","write":[13,-2.5e999,{"x":1e400}]})",
          R"({"id":"7","write":[1e400,1e400],"by":"anna","reply_to":"mine","hold_ms":1e400})"}) {
        const auto envelope = open_envelope(request(payload));
        ASSERT_FALSE(envelope) << payload;
        EXPECT_EQ(envelope.error().reply, (ReplyTo{"mine", "", "7", "anna"})) << payload;
        EXPECT_EQ(envelope.error().error, "a number in the request is too large");
    }
    const auto as_id = open_envelope(request(R"({"id":1e400,"reply_to":"mine"})"));
    ASSERT_FALSE(as_id);
    EXPECT_EQ(as_id.error().reply, (ReplyTo{"mine", "", ""}));
    std::string many = R"({"reply_to":"mine","write":[0)";
    while (many.size() < kMaxRequestBytes - 20)
        many += ",1e400";
    const auto of_many = open_envelope(request(many + R"(],"id":"7"})"));
    ASSERT_FALSE(of_many);
    EXPECT_EQ(of_many.error().reply, (ReplyTo{"mine", "", ""}));
}

TEST(Envelope, BrokenJson_RequesterIsKnownFromWhatStandsBeforeTheFault) {
    const std::string start = R"({"id":7,"reply_to":"mine")";
    for (const std::string& rest :
         {std::string(), std::string(R"(,"write":[13,1)"), std::string(",\"write\":\"\xff\"}"),
          std::string(R"(,"write":[13,1]}})"), std::string(",\0}", 3), std::string(R"(,"write":01})")}) {
        const auto envelope = open_envelope(request(start + rest));
        ASSERT_FALSE(envelope) << rest;
        EXPECT_EQ(envelope.error().reply, (ReplyTo{"mine", "", "7"})) << rest;
        EXPECT_EQ(envelope.error().error, "the request is not valid JSON");
    }
    for (const char* payload : {R"({"x":{"reply_to":"mine","id":"7"})", R"({"reply_to":"a/#",)",
                                R"({"write":[13,1],"reply_to":"min)", R"({"reply_to":["mine"],"id":)"}) {
        const auto envelope = open_envelope(request(payload));
        ASSERT_FALSE(envelope) << payload;
        EXPECT_FALSE(envelope.error().reply.wanted()) << payload;
    }
    auto message = request(R"({"id":"7","reply_to":"other","write":[)");
    message.response_topic = "mine";
    message.correlation = "c";
    const auto envelope = open_envelope(message);
    ASSERT_FALSE(envelope);
    EXPECT_EQ(envelope.error().reply, (ReplyTo{"mine", "c", "7", "", true}));
}

TEST(Envelope, BeyondALimit_RequesterIsKnownFromWhatStandsBeforeIt) {
    const std::string start = R"({"id":"7","reply_to":"mine","write":)";
    for (const auto& rest : {'"' + std::string(kMaxRequestBytes, 'x') + "\"}", std::string(40, '[')}) {
        const auto envelope = open_envelope(request(start + rest));
        ASSERT_FALSE(envelope);
        EXPECT_EQ(envelope.error().reply, (ReplyTo{"mine", "", "7"}));
    }
    const auto behind =
        open_envelope(request("{" + std::string(kMaxRequestBytes, ' ') + start.substr(1) + "1}"));
    ASSERT_FALSE(behind);
    EXPECT_FALSE(behind.error().reply.wanted());
}

TEST(Envelope, AtEachLimit_IsAcceptedAndOneBeyondIsRefused) {
    const auto nested = [](int depth) {
        const auto inner = static_cast<std::size_t>(depth - 1);
        return R"({"x":)" + std::string(inner, '[') + std::string(inner, ']') + "}";
    };
    const auto with_id = [](std::size_t bytes) { return R"({"id":")" + std::string(bytes, 'i') + "\"}"; };
    const auto of_size = [](std::size_t bytes) {
        const std::string around = R"({"x":""})";
        return R"({"x":")" + std::string(bytes - around.size(), 'x') + "\"}";
    };
    EXPECT_TRUE(open_envelope(request(nested(16))));
    EXPECT_FALSE(open_envelope(request(nested(17))));
    EXPECT_TRUE(open_envelope(request(with_id(128))));
    EXPECT_FALSE(open_envelope(request(with_id(129))));
    EXPECT_TRUE(open_envelope(request(of_size(16384))));
    EXPECT_FALSE(open_envelope(request(of_size(16385))));
}

TEST(Envelope, LargestRequest_ReachesEncoderAndQueryReaderWhole) {
    const auto padding = std::string(16000, ' ') + "}";
    const auto query = open_envelope(request(R"({"find":"boards","kind":["a","b"])" + padding));
    ASSERT_TRUE(query) << query.error().error;
    EXPECT_TRUE(read_registry_request(query->object));
    const auto command =
        open_envelope(request(R"({"raw":"q,1","id":")" + std::string(100, 'i') + '"' + padding));
    ASSERT_TRUE(command) << command.error().error;
    EXPECT_EQ(model::encode_control_text(nullptr, 'X', command->text)->line, "X,q,1");
}

TEST(Envelope, ResponseTopicOrCorrelationThatCannotBeUsed_IsRefused) {
    // The last ones no MQTT library publishes on: a noncharacter, a control character, no UTF-8.
    for (const char* topic : {"a/+", "#", "$share/x", "a\nb", "a/\uffff", "a/\u0085", "a/\xff"}) {
        auto message = request("W,0,90");
        message.response_topic = topic;
        const auto envelope = open_envelope(message);
        ASSERT_FALSE(envelope);
        EXPECT_FALSE(envelope.error().reply.wanted());
    }
    auto message = request("W,0,90");
    message.response_topic = "ok";
    message.correlation = std::string(kMaxCorrelationBytes + 1, 'x');
    const auto envelope = open_envelope(message);
    ASSERT_FALSE(envelope);
    EXPECT_EQ(envelope.error().reply.topic, "ok");
    EXPECT_EQ(envelope.error().reply.correlation, "");
}

}  // namespace
}  // namespace asip::bus
