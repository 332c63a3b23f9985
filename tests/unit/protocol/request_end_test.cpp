// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/request_end.hpp"

#include <gtest/gtest.h>

namespace asip::protocol {
namespace {

TEST(NextRequest, LetterAndCommaBehindARequest_BeginIt) {
    EXPECT_EQ(next_request("M,m,1,100M,m,0,-100"), 9u);
    EXPECT_EQ(next_request("D,MR,A,25"), 3u);
    EXPECT_EQ(next_request("I,A,0#,?"), 5u);
    EXPECT_EQ(next_request("M,E,R,A,25"), 4u);
    EXPECT_EQ(next_request("M,M,100,-100"), std::string_view::npos) << "its own tag";
    EXPECT_EQ(next_request("M,m,1,100M"), std::string_view::npos) << "the comma may still come";
}

TEST(NextRequest, Text_IsNotCut) {
    EXPECT_EQ(next_request("L,W,1,LINE A,B"), std::string_view::npos);
    EXPECT_EQ(next_request("#,I,A,B"), std::string_view::npos);
    EXPECT_EQ(next_request("!note A,B"), std::string_view::npos);
}

TEST(WholeRequest, AsManyNumbersAsItsTagNeeds) {
    for (const char* whole : {"M,m,1,100", "M,m,1,-100", "M,m,0,12.75", "I,a,9, 64", "E,A,25", "D,M", "M,S",
                              "M,E,", "I,M", "P,P,2,{0:255,1:0}", "N,C,0,1,2,3,4", "X,y,7", "#,?"})
        EXPECT_TRUE(is_whole_request(whole)) << whole;
    for (const char* half : {"M,m,1", "M,m,1,", "M,m,", "M,m", "M,m,1,5,", "I,P,13", "E,A", "E,A,", "M,m,1,-",
                             "M,m,,5", "M,M,5", "P,P,2,{0:255,1:", "M", "M,", "", "m,1,100", "3,1"})
        EXPECT_FALSE(is_whole_request(half)) << half;
}

TEST(WholeRequest, NamesAndTokens_AreNotWholeBecauseNothingMoreComes) {
    EXPECT_TRUE(is_whole_after_silence("#,?"));
    EXPECT_FALSE(is_whole_after_silence("#,I,un"));
    EXPECT_FALSE(is_whole_after_silence("#,E,t1"));
    EXPECT_TRUE(is_whole_after_silence("M,m,1,100"));
}

}  // namespace
}  // namespace asip::protocol
