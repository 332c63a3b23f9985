// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/message.hpp"

#include <gtest/gtest.h>

namespace asip::protocol {
namespace {

template <class T>
T parse_as(std::string_view line) {
    const auto message = parse_line(line);
    const auto* result = std::get_if<T>(&message);
    EXPECT_NE(result, nullptr) << line << " is message kind " << message.index();
    return result != nullptr ? *result : T{};
}

TEST(ParseLine, Event_IsServiceTagAndBody) {
    const auto event = parse_as<Event>("@D,e,2,{42,118}");
    EXPECT_EQ(event.service, 'D');
    EXPECT_EQ(event.tag, 'e');
    EXPECT_EQ(event.body, "2,{42,118}");
}

TEST(ParseLine, SystemEvent_HasServiceHash) {
    const auto event = parse_as<Event>("@#,?,0,4,ATmega328P,20,AsipHello");
    EXPECT_EQ(event.service, '#');
    EXPECT_EQ(event.tag, '?');
    EXPECT_EQ(event.body, "0,4,ATmega328P,20,AsipHello");
}

TEST(ParseLine, EventWithoutBody_HasEmptyBody) {
    EXPECT_EQ(parse_as<Event>("@I,P").body, "");
    EXPECT_EQ(parse_as<Event>("@I,P,").body, "");
}

TEST(ParseLine, Error_IsCodeAndText) {
    const auto error = parse_as<ErrorReply>("~S,W,7{INVALID_DEVICE_NUMBER}");
    EXPECT_EQ(error.service, 'S');
    EXPECT_EQ(error.tag, 'W');
    EXPECT_EQ(error.code, 7);
    EXPECT_EQ(error.text, "INVALID_DEVICE_NUMBER");
}

TEST(ParseLine, ErrorOfUnknownService_IsUnderstood) {
    const auto error = parse_as<ErrorReply>("~Q,?,1{INVALID_SERVICE}");
    EXPECT_EQ(error.service, 'Q');
    EXPECT_EQ(error.tag, '?');
    EXPECT_EQ(error.code, 1);
    EXPECT_EQ(parse_as<ErrorReply>("~h,?,1{INVALID_SERVICE}").service, 'h');
    EXPECT_EQ(parse_as<ErrorReply>("~,,?,1{INVALID_SERVICE}").service, ',');
}

TEST(ParseLine, ErrorWithCommaOrWithoutText_IsUnderstood) {
    EXPECT_EQ(parse_as<ErrorReply>("~I,d,6,{WRONG_MODE}").text, "WRONG_MODE");
    EXPECT_EQ(parse_as<ErrorReply>("~I,d,6").code, 6);
    EXPECT_EQ(parse_as<ErrorReply>("~I,d,6{}").text, "");
}

TEST(ParseLine, Info_IsTextAfterTheMark) {
    EXPECT_EQ(parse_as<Info>("!AsipHello running on Uno").text, "AsipHello running on Uno");
    EXPECT_EQ(parse_as<Info>("!").text, "");
}

TEST(ParseLine, BytesBeyondAsciiInNamesAndWords_PassAndNowhereElse) {
    for (const std::string_view line :
         {"@#,?,0,4,ATmega328P,20,T\xc3\xbcr", "@#,?,0,4,ATmega328P,20,\xff\xfe",
          "@#,N,1,{D:K\xc3\xbc"
          "che}",
          "~S,W,7{kein \xc3\xa4}", "~S,W,7,{\xff}"})
        EXPECT_FALSE(std::holds_alternative<Malformed>(parse_line(line))) << line;
    for (const std::string_view line :
         {"@#,?,0,4,ATmega328P\xff,20,T", "@#,?,0\xff,4,ATmega328P,20,T", "@#,?\xff,0", "@#,N,\xff,{D:K}",
          "@#,N\xff,1,{D:K}", "~S,W,\xff{A}", "~\xff,W,7{A}", "@#,S,1,{\xff}", "@#,E,\xff", "@I,d,4,\xff",
          "@#,?,\xff", "@#,?,0,4,ATmega328P,20,T\x07r", "@#,N,1,{D:K\x1b}"})
        EXPECT_TRUE(std::holds_alternative<Malformed>(parse_line(line))) << line;
}

TEST(ParseLine, DamagedLine_IsMalformed) {
    for (const std::string_view line :
         {"", "x", "D,e,2", "@", "@D", "@D,", "@De,2", "@d,e,1", "@D,,1", "@D,ee,1", "~S,W", "~S,W,",
          "~S,W,x{A}", "~S,W,-1{A}", "~S,W,7{INVALID", "~S,W,7INVALID}", "~S,W,99999999999{A}",
          "@D,e,2,{4\x01,1}", "@D,e,2,{4\xff}"}) {
        EXPECT_TRUE(std::holds_alternative<Malformed>(parse_line(line))) << line;
    }
}

TEST(ErrorName, KnownAndUnknownCodes_HaveAName) {
    EXPECT_EQ(error_name(ErrorCode::kNoError), "NO_ERROR");
    EXPECT_EQ(error_name(9), "I2C_NOT_ENABLED");
    EXPECT_EQ(error_name(ErrorCode::kBadArgument), "BAD_ARGUMENT");
    EXPECT_EQ(error_name(12), "UNKNOWN_ERROR");
    EXPECT_EQ(error_name(-1), "UNKNOWN_ERROR");
}

}  // namespace
}  // namespace asip::protocol
