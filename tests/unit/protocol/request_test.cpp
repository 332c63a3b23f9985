// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/request.hpp"

#include <gmock/gmock.h>

#include "asip/protocol/limits.hpp"

namespace asip::protocol {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(MakeRequest, Helpers_WriteTheWire) {
    EXPECT_EQ(make_request('S', 'W', {0, 90}), "S,W,0,90");
    EXPECT_EQ(make_request('D', 'M'), "D,M");
    EXPECT_EQ(set_pin_mode(13, PinMode::kOutput), "I,P,13,3");
    EXPECT_EQ(digital_write(13, true), "I,d,13,1");
    EXPECT_EQ(analog_write(3, 128), "I,a,3,128");
    EXPECT_EQ(echo("a1"), "#,E,a1");
    EXPECT_EQ(set_line_rate(500000), "#,B,500000");
    EXPECT_EQ(set_checksum(true), "#,C,1");
}

TEST(ParseRequest, Line_IsServiceTagAndParameters) {
    const auto request = parse_request("S,W,0,90");
    ASSERT_TRUE(request);
    EXPECT_EQ(request->service, 'S');
    EXPECT_EQ(request->tag, 'W');
    EXPECT_EQ(request->parameters, "0,90");
    EXPECT_EQ(parse_request("#,?")->parameters, "");
    EXPECT_EQ(parse_request("L,W,")->parameters, "");
}

TEST(ParseRequest, WhatIsNoRequest_IsRefused) {
    for (const std::string_view line : {"", "S", "S,", "SW", "s,W", "S,W0", "S,,0", "S, ,0", "!debug",
                                        "@D,e,1", "S,W\n", "S,W\r", "S,W,\t", "S,W,\xff"}) {
        EXPECT_FALSE(parse_request(line)) << line;
    }
}

TEST(ParseRequest, LongerThanABoardTakes_IsRefused) {
    const std::string longest = "L,W," + std::string(kMaxRequestBytes - 4, 'x');
    EXPECT_TRUE(parse_request(longest));
    EXPECT_THAT(parse_request(longest + "x").error(), HasSubstr("251 bytes long, above 250"));
}

std::vector<std::string_view> lines_of(std::string_view payload) {
    std::vector<std::string_view> lines;
    const auto requests = split_requests(payload);
    for (const auto& request : requests.value())
        lines.push_back(request.line);
    return lines;
}

TEST(SplitRequests, NewlinePresentOrNot_GivesTheSame) {
    for (const std::string_view payload : {"I,M", "I,M\n", "I,M\r\n", "\nI,M\n\n", "I,M\r", "I,M\n\r"})
        EXPECT_THAT(lines_of(payload), ElementsAre("I,M")) << payload;
    EXPECT_THAT(lines_of("I,M\nI,m\r\nI,p\rI,c\n\rI,M"), ElementsAre("I,M", "I,m", "I,p", "I,c", "I,M"));
}

TEST(SplitRequests, WhatBoardsIgnore_IsLeftOut) {
    for (const std::string_view payload : {"I,M ", "I,M  \r\n", "I,M \r", "!hello\nI,M", "I,M\n!bye",
                                           "   \nI,M\n \r\n", " I,M", "\t\x1b I,M", "I,M\t"}) {
        EXPECT_THAT(lines_of(payload), ElementsAre("I,M")) << payload;
    }
    EXPECT_THAT(lines_of(std::string_view("\0I,M\0\n\0", 7)), ElementsAre("I,M"))
        << "as C programs end texts";
    EXPECT_FALSE(split_requests("!hello"));
}

TEST(SplitRequests, OneBadLine_RefusesThemAll) {
    EXPECT_FALSE(split_requests("I,M\nbad\nI,p"));
}

TEST(SplitRequests, EmptyPayload_IsRefused) {
    EXPECT_FALSE(split_requests(""));
    EXPECT_FALSE(split_requests("\r\n\n"));
}

TEST(SplitRequests, TooManyOrTooMuch_IsRefused) {
    std::string payload;
    for (std::size_t i = 0; i < kMaxRequestsPerPayload; ++i)
        payload += "I,M\n";
    EXPECT_EQ(split_requests(payload)->size(), kMaxRequestsPerPayload);
    EXPECT_FALSE(split_requests(payload + "I,M"));
    EXPECT_FALSE(split_requests(std::string(1'000'000, '\n')));
}

TEST(SplitRequests, BinaryPayload_IsRefused) {
    EXPECT_FALSE(split_requests(std::string_view("I,\0M\n", 5)));
    EXPECT_FALSE(split_requests("\xffI,M"));
}

}  // namespace
}  // namespace asip::protocol
