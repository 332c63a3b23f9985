#include <gmock/gmock.h>

#include "asip/model/command_encoder.hpp"
#include "asip/model/model_set.hpp"

namespace asip::model {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const ServiceModel& servo() {
    return *ModelSet::standard().find("servo");
}

TEST(ReadControl, EachForm_GivesTheSameLine) {
    for (const std::string_view payload :
         {R"({"write":[0,90]})", R"({"write":{"servo":0,"angle":90}})", "W,0,90", "W,0,90\n", "W,0,90\r\n",
          R"(  {"raw":"W,0,90"})", R"({"write":[0,90],"id":"a","reply_to":"b"})"}) {
        const auto request = read_control(&servo(), 'S', payload);
        ASSERT_TRUE(request.command) << payload << ": " << request.command.error();
        EXPECT_EQ(request.command->line, "S,W,0,90") << payload;
    }
}

TEST(ReadControl, RefusedCommand_StillSaysWhomToAnswer) {
    const auto request = read_control(&servo(), 'S', R"({"write":[0,900],"id":17,"reply_to":"app/answers"})");
    ASSERT_FALSE(request.command);
    EXPECT_EQ(request.command.error(), "angle: 900 is above 180");
    EXPECT_EQ(request.id, "17");
    EXPECT_EQ(request.reply_to, "app/answers");
}

TEST(ReadControl, HostileIdAndReplyTo_AreDropped) {
    for (const auto* topic : {"a/+/b", "#", "$SYS/x", "a\\u0000b", "a\\nb"}) {
        const auto request =
            read_control(&servo(), 'S', std::string(R"({"write":[0,9],"reply_to":")") + topic + "\"}");
        EXPECT_EQ(request.reply_to, "") << topic;
    }
    EXPECT_EQ(read_control(&servo(), 'S', R"({"write":[0,9],"id":")" + std::string(65, 'x') + "\"}").id, "");
    EXPECT_EQ(read_control(&servo(), 'S', R"({"write":[0,9],"id":{}})").id, "");
}

TEST(ReadControl, ServiceWithoutModel_TakesTextOnly) {
    EXPECT_EQ(read_control(nullptr, 'X', "q,1").command->line, "X,q,1");
    EXPECT_EQ(read_control(nullptr, 'X', R"({"raw":"q,1","id":"1"})").command->line, "X,q,1");
    EXPECT_THAT(read_control(nullptr, 'X', R"({"go":[1]})").command.error(),
                HasSubstr("no model describes service X"));
    EXPECT_FALSE(read_control(nullptr, 'X', "").command);
}

TEST(ReadControl, HostilePayload_IsRefused) {
    for (const auto& payload :
         {std::string("{"), std::string("[1]"), std::string("{}"), std::string(1'000'000, 'x'),
          std::string(1'000'000, '['), std::string("W,0\n,90"), std::string("W,0,90\nW,1,90"),
          std::string("\0\1\2", 3), std::string(R"({"raw":7})")}) {
        EXPECT_FALSE(read_control(&servo(), 'S', payload).command) << payload.substr(0, 20);
    }
}

TEST(ReadRawControl, LinesOrObject_GiveTheLines) {
    EXPECT_THAT(read_raw_control("I,M\nI,p").lines.value(), ElementsAre("I,M", "I,p"));
    const auto request = read_raw_control(R"({"raw":"#,?","reply_to":"me","id":"9"})");
    EXPECT_THAT(request.lines.value(), ElementsAre("#,?"));
    EXPECT_EQ(request.reply_to, "me");
    EXPECT_EQ(request.id, "9");
    EXPECT_THAT(read_raw_control(R"({"raw":["I,M","I,p"]})").lines.value(), ElementsAre("I,M", "I,p"));
}

TEST(ReadRawControl, HostilePayload_IsRefused) {
    for (const std::string_view payload : {"", "hello", "{}", R"({"raw":1})", R"({"raw":[1]})",
                                           R"({"raw":""})", R"({"raw":"x"})", "[\"I,M\"]"}) {
        EXPECT_FALSE(read_raw_control(payload).lines) << payload;
    }
}

}  // namespace
}  // namespace asip::model
