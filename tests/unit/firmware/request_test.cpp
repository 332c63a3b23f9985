// SPDX-License-Identifier: Apache-2.0
#include "asip/Request.h"

#include <gtest/gtest.h>

#include <utility>

namespace asip {
namespace {

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

TEST(RequestTest, NumberAboveItsMaximum_SpoilsTheRequest) {
    Request request("S,W,0,181");
    request.number();
    EXPECT_EQ(request.number(180), 0);
    EXPECT_FALSE(request.complete());
}

TEST(RequestTest, More_SaysWhetherAnArgumentFollows) {
    Request request("S,M,4");
    EXPECT_TRUE(request.more());
    request.number();
    EXPECT_FALSE(request.more());
}

}  // namespace
}  // namespace asip
