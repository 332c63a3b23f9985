// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/request_envelope.hpp"

#include <gtest/gtest.h>

namespace asip::bus {
namespace {

TEST(ReplyTopics, Answer_ComesBelowWhoAsksAndWhoIsAsked) {
    const Topics topics("plant/asip");
    const ReplyTopics replies(topics, "ann", "c1");
    EXPECT_EQ(replies.filter(), "plant/asip/reply/ann/+/c1");
    for (const auto& request :
         {topics.board_in("uno1"), topics.service_in("uno1", "servo"), topics.stop("uno1")})
        EXPECT_EQ(replies.to(request), "plant/asip/reply/ann/uno1/c1") << request;
    for (const auto& request : {topics.any_registry_query(), topics.registry_query("hall")})
        EXPECT_EQ(replies.to(request), "plant/asip/reply/ann/registry/c1") << request;
    EXPECT_EQ(replies.own(), "plant/asip/reply/ann/$self/c1");
}

TEST(ReplyTopics, Parts_AreLevelsBelow) {
    const auto part = ReplyTopics(Topics(), "ann", "c1").below("s1").below("x");
    EXPECT_EQ(part.to("asip/uno1/in"), "asip/reply/ann/uno1/c1/s1/x");
    EXPECT_EQ(part.filter(), "asip/reply/ann/+/c1/s1/x");
}

TEST(ReplyTopics, UserThatIsNoLevel_IsNobody) {
    for (const char* user : {"", "a/b", "a+", "#", "a\nb", "a\x7f"})
        EXPECT_EQ(ReplyTopics(Topics(), user, "c1").to("asip/uno1/in"), "asip/reply/$nobody/uno1/c1") << user;
}

TEST(ReplyTopics, TopicsOfOthers_AreNotIts) {
    const ReplyTopics replies(Topics(), "ann", "c1");
    EXPECT_TRUE(replies.have("asip/reply/ann/uno1/c1"));
    EXPECT_TRUE(replies.have("asip/reply/ann/$self/c1"));
    for (const char* topic : {"asip/reply/ann/uno1/c11", "asip/reply/ann/uno1/c1/x", "asip/reply/ann/c1",
                              "asip/reply/anna/uno1/c1", "asip/reply/ann/a/b/c1", "asip/reply/ann/", "", "x"})
        EXPECT_FALSE(replies.have(topic)) << topic;
    EXPECT_TRUE(replies.of_user("asip/reply/ann/uno1/c2"));
    EXPECT_FALSE(replies.of_user("asip/reply/anna/uno1/c1"));
}

TEST(MayAnswerOn, OnlyBelowTheLevelOfTheAnswererInReplyTopics) {
    const Topics topics("plant/asip");
    for (const char* topic : {"plant/asip/reply/ann/uno1/c1", "plant/asip/reply/$nobody/uno1/c1/s1"})
        EXPECT_TRUE(may_answer_on(topic, topics, "uno1")) << topic;
    EXPECT_TRUE(may_answer_on("plant/asip/reply/ann/registry/c1", topics, "registry"));
    for (const char* topic :
         {"plant/asip/reply/ann/uno1", "plant/asip/reply/ann/uno1/", "plant/asip/reply/ann/uno11/c1",
          "plant/asip/reply/ann/uno2/c1", "plant/asip/reply//uno1/c1", "plant/asip/reply/uno1/c1",
          "plant/asip/uno1/out", "plant/asip/uno1/distance/out", "plant/asip/uno1/in",
          "plant/asip/servicebus/uno1/$state", "asip/reply/ann/uno1/c1", "reply", "", "plant/asip/reply/"})
        EXPECT_FALSE(may_answer_on(topic, topics, "uno1")) << topic;
}

TEST(ReplyTopics, OfUrgentAnswers_AreThoseOfTheSameClient) {
    const ReplyTopics topics(Topics(), "ann", "gw-1f");
    const auto urgent = topics.urgent().below("s").to("asip/uno1/$stop");
    EXPECT_EQ(urgent, "asip/reply/ann/uno1/gw-1f-urgent/s");
    EXPECT_EQ(ReplyTopics::without_urgent(urgent), topics.below("s").to("asip/uno1/in"));
    for (const char* other : {"asip/reply/ann/uno1/gw-1f", "asip/reply/ann/uno1/gw-urgently", ""})
        EXPECT_EQ(ReplyTopics::without_urgent(other), other);
}

}  // namespace
}  // namespace asip::bus
