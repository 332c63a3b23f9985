// SPDX-License-Identifier: Apache-2.0
#include "asip/Request.h"

#include <gtest/gtest.h>

#include <utility>

namespace asip {
namespace {

TEST(RequestTest, Numbers_AreReadInOrder) {
    Request request("S,W,3,180");
    EXPECT_EQ(request.tag(), 'W');
    EXPECT_EQ(request.number(), 3);
    EXPECT_EQ(request.number(180), 180);
    EXPECT_TRUE(request.complete());
}

TEST(RequestTest, MissingNumber_SpoilsTheRequest) {
    Request request("S,W,3");
    EXPECT_EQ(request.number(), 3);
    EXPECT_EQ(request.number(), 0);
    EXPECT_FALSE(request.complete());
}

TEST(RequestTest, NumberWithoutDigits_SpoilsTheRequest) {
    for (const char* line : {"I,d,", "I,d,x", "I,d,-1", "I,d, ", "I,d,+1", "I,d,.5"}) {
        Request request(line);
        EXPECT_EQ(request.number(), 0) << line;
        EXPECT_FALSE(request.complete()) << line;
    }
}

TEST(RequestTest, SomethingAfterTheNumber_SpoilsTheRequest) {
    for (const char* line : {"I,A,1x", "I,A,1 2", "I,A,1,", "I,A,1,2", "I,A,1.5.2", "I,A,1.x"}) {
        Request request(line);
        request.number();
        EXPECT_FALSE(request.complete()) << line;
    }
}

TEST(RequestTest, BlanksAroundANumber_DoNotCount) {
    Request request("I,a,9, 64");
    EXPECT_EQ(request.number(), 9);
    EXPECT_EQ(request.number(255), 64);
    EXPECT_TRUE(request.complete());
    Request spacious("M,M,  -5 ,  7  ");
    EXPECT_EQ(spacious.signedNumber(255), -5);
    EXPECT_EQ(spacious.signedNumber(255), 7);
    EXPECT_TRUE(spacious.complete());
}

TEST(RequestTest, WhatFollowsADecimalPoint_DoesNotCount) {
    Request request("M,M,12.5,-3.999");
    EXPECT_EQ(request.signedNumber(255), 12);
    EXPECT_EQ(request.signedNumber(255), -3);
    EXPECT_TRUE(request.complete());
    Request point("M,m,1.,2");
    EXPECT_EQ(point.number(), 1);
    EXPECT_EQ(point.number(), 2);
    EXPECT_TRUE(point.complete());
}

TEST(RequestTest, ClampedNumberBeyondItsBounds_ReadsAsTheBound) {
    for (const auto& [line, value] : {std::pair{"S,W,200", 180},
                                      {"S,W,181", 180},
                                      {"S,W,180", 180},
                                      {"S,W,-5", 0},
                                      {"S,W,70000", 180},
                                      {"S,W,99999999999", 180},
                                      {"S,W,0", 0}}) {
        Request request(line);
        EXPECT_EQ(request.clampedNumber(180), value) << line;
        EXPECT_TRUE(request.complete()) << line;
    }
    for (const auto& [line, value] : {std::pair{"M,m,300", 255},
                                      {"M,m,-300", -255},
                                      {"M,m,-70000", -255},
                                      {"M,m,-255", -255},
                                      {"M,m,1000000", 255}}) {
        Request request(line);
        EXPECT_EQ(request.clampedSignedNumber(255), value) << line;
        EXPECT_TRUE(request.complete()) << line;
    }
}

TEST(RequestTest, ClampedNumberThatIsMalformed_SpoilsTheRequest) {
    for (const char* line : {"S,W", "S,W,", "S,W,x", "S,W,-", "S,W,1x", "S,W,--1"}) {
        Request request(line);
        request.clampedNumber(180);
        EXPECT_FALSE(request.complete()) << line;
    }
}

TEST(RequestTest, LargestNumber_IsTaken) {
    Request request("I,A,65535");
    EXPECT_EQ(request.number(), 65535);
    EXPECT_TRUE(request.complete());
}

TEST(RequestTest, NumberAbove16Bits_SpoilsTheRequestAndDoesNotWrap) {
    for (const char* line : {"I,A,65536", "I,A,65540", "I,A,70000", "I,A,131073", "I,A,4294967297"}) {
        Request request(line);
        EXPECT_EQ(request.number(), 0) << line;
        EXPECT_FALSE(request.complete()) << line;
    }
}

TEST(RequestTest, LeadingZeros_DoNotCount) {
    Request request("I,A,0000000042");
    EXPECT_EQ(request.number(), 42);
    EXPECT_TRUE(request.complete());
}

TEST(RequestTest, NumberAboveItsMaximum_SpoilsTheRequest) {
    Request request("S,W,0,181");
    request.number();
    EXPECT_EQ(request.number(180), 0);
    EXPECT_FALSE(request.complete());
}

TEST(RequestTest, SignedNumbers_AreReadWithinTheirMagnitude) {
    Request request("M,M,-255,255");
    EXPECT_EQ(request.signedNumber(255), -255);
    EXPECT_EQ(request.signedNumber(255), 255);
    EXPECT_TRUE(request.complete());
}

TEST(RequestTest, SignedNumberOutOfRange_SpoilsTheRequest) {
    for (const char* line : {"M,m,-256", "M,m,256", "M,m,--1", "M,m,-", "M,m,-66000", "M,m,"}) {
        Request request(line);
        EXPECT_EQ(request.signedNumber(255), 0) << line;
        EXPECT_FALSE(request.complete()) << line;
    }
}

TEST(RequestTest, Text_IsTheRestOfTheLine) {
    Request request("L,W,2,hello, world");
    EXPECT_EQ(request.number(), 2);
    EXPECT_STREQ(request.text(), "hello, world");
    EXPECT_TRUE(request.complete());
}

TEST(RequestTest, TextThatNoCommaBegins_SpoilsTheRequest) {
    for (const char* line : {"L,W,1hello", "L,W,1 hello", "J,t,118,1D0"}) {
        Request request(line);
        request.number();
        while (request.more())
            request.number();
        request.text();
        EXPECT_FALSE(request.complete()) << line;
    }
    Request none("J,t,118");
    EXPECT_EQ(none.number(), 118);
    EXPECT_STREQ(none.text(), "");
    EXPECT_TRUE(none.complete());
}

TEST(RequestTest, More_SaysWhetherAnArgumentFollows) {
    Request request("S,M,4");
    EXPECT_TRUE(request.more());
    request.number();
    EXPECT_FALSE(request.more());
}

}  // namespace
}  // namespace asip
