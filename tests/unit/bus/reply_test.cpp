// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/reply.hpp"

#include <gtest/gtest.h>

namespace asip::bus {
namespace {

TEST(Reply, EachStatus_HasTheTextOfTheProtocolAndReadsBack) {
    auto ok = Reply::ok("fence");
    ok.id = "7";
    EXPECT_EQ(to_json_text(ok), R"({"id":"7","proof":"fence","status":"ok"})");
    EXPECT_EQ(to_json_text(Reply::board_error(7, "INVALID_DEVICE_NUMBER")),
              R"({"code":7,"error":"INVALID_DEVICE_NUMBER","status":"error"})");
    EXPECT_EQ(to_json_text(Reply::timeout()), R"({"status":"timeout"})");
    EXPECT_EQ(to_json_text(Reply::refused("queue-full", "too many commands wait")),
              R"({"error":"too many commands wait","reason":"queue-full","status":"refused"})");
    for (const auto& reply : {ok, Reply::ok("answer", R"({"a":[1,2]})"), Reply::board_error(2, "x"),
                              Reply::timeout(), Reply::refused("invalid", "y")}) {
        const auto back = parse_reply(to_json_text(reply));
        ASSERT_TRUE(back) << back.error();
        EXPECT_EQ(*back, reply);
    }
}

TEST(Reply, AnswerThatIsNotJson_BecomesAString) {
    EXPECT_EQ(to_json_text(Reply::ok("answer", "@I,x")),
              R"({"answer":"@I,x","proof":"answer","status":"ok"})");
}

TEST(Reply, BytesThatAreNotUtf8_AreReplaced) {
    const auto text = to_json_text(Reply::board_error(1, "bad \xff byte"));
    const auto back = parse_reply(text);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->error, "bad \xef\xbf\xbd byte");
}

TEST(ParseReply, UnknownMembers_AreIgnored) {
    const auto reply = parse_reply(R"({"status":"ok","later":{"x":1},"id":7})");
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->id, "7");
}

TEST(ParseReply, WordsThatAreEscapedOrGivenTwice_AreReadAsAnyJson) {
    for (const char* text :
         {R"( { "status" : "ok" , "id" : "a\"b" } )", R"({"st\u0061tus":"ok","id":"a\u0022b"})",
          R"({"status":"error","id":"x","status":"ok","id":"a\"b"})"}) {
        const auto reply = parse_reply(text);
        ASSERT_TRUE(reply) << text;
        EXPECT_TRUE(reply->succeeded()) << text;
        EXPECT_EQ(reply->id, "a\"b") << text;
    }
    EXPECT_EQ(parse_reply(R"({"status":"error","id":"x","status":"ok","id":"y"})")->id, "y");
    EXPECT_FALSE(parse_reply(R"({"status":"ok"} x)"));
    EXPECT_FALSE(parse_reply(R"({"status":"ok",})"));
}

TEST(ParseReply, NotAReply_Fails) {
    for (const char* text :
         {"", "ok", "[]", "{}", R"({"status":"fine"})", R"({"status":1})", R"({"status":"ok")"}) {
        EXPECT_FALSE(parse_reply(text)) << text;
    }
    EXPECT_FALSE(parse_reply(std::string(100000, '[')));
    EXPECT_EQ(parse_reply(R"({"status":"error","code":99999999999})")->code, 0);
}

TEST(ReplyMessage, WantedWithId_GoesToTheTopicWithIdAndCorrelation) {
    const auto message = reply_message({"a/b", "corr", "7"}, Reply::timeout());
    ASSERT_TRUE(message);
    EXPECT_EQ(message->topic, "a/b");
    EXPECT_EQ(message->correlation, "corr");
    EXPECT_EQ(message->qos, 1);
    EXPECT_EQ(message->payload, R"({"id":"7","status":"timeout"})");
}

TEST(ReplyMessage, Clock_IsAUserPropertyWhereThereAreSomeElseAMember) {
    auto reply = Reply::ok("fence");
    reply.clock = "1f3c09aa-7";
    ReplyTo to{"a/b", "", "7"};
    EXPECT_EQ(reply_message(to, reply)->payload,
              R"({"clock":"1f3c09aa-7","id":"7","proof":"fence","status":"ok"})");
    EXPECT_EQ(parse_reply(reply_message(to, reply)->payload)->clock, "1f3c09aa-7");
    to.properties = true;
    EXPECT_EQ(reply_message(to, reply)->payload, R"({"id":"7","proof":"fence","status":"ok"})");
    EXPECT_EQ(reply_message(to, reply)->user_properties,
              (std::vector<std::pair<std::string, std::string>>{{"clock", "1f3c09aa-7"}}));
}

TEST(ReplyMessage, NobodyAsked_IsNothing) {
    EXPECT_FALSE(reply_message({}, Reply::timeout()));
}

TEST(ReplyTo, Key_IsTheIdElseTheCorrelation) {
    EXPECT_EQ((ReplyTo{"t", "c", "i"}).key(), "i");
    EXPECT_EQ((ReplyTo{"t", "c", ""}).key(), "c");
    EXPECT_EQ((ReplyTo{"t", "", ""}).key(), "");
}

}  // namespace
}  // namespace asip::bus
