// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/message.hpp"

#include <gmock/gmock.h>

namespace asip::gateway::http {
namespace {

using testing::ElementsAre;
using testing::Pair;

Request request_to(std::string target) {
    Request request;
    request.target = std::move(target);
    return request;
}

TEST(HttpTarget, PathAndQuery_AreTakenApartAndDecoded) {
    auto request = request_to("/api/boards/uno%31?board=a%2Ab&sketch=two+words&full");
    ASSERT_TRUE(split_target(request));
    EXPECT_THAT(request.segments, ElementsAre("api", "boards", "uno1"));
    EXPECT_THAT(request.query,
                ElementsAre(Pair("board", "a*b"), Pair("sketch", "two words"), Pair("full", "")));
}

TEST(HttpTarget, Root_HasNoSegments) {
    auto request = request_to("/?code=x");
    ASSERT_TRUE(split_target(request));
    EXPECT_TRUE(request.segments.empty());
}

TEST(HttpTarget, SlashAtTheEnd_IsAFolder) {
    auto request = request_to("/kiosk/secret/?x=1");
    ASSERT_TRUE(split_target(request));
    EXPECT_THAT(request.segments, ElementsAre("kiosk", "secret"));
    EXPECT_TRUE(request.folder);
}

TEST(HttpTarget, AbsoluteForm_IsThePathAndItsAuthorityIsTheHost) {
    auto request = request_to("HTTP://Lab.example:8080/api/boards?board=a");
    request.headers = {{"host", "other.example"}, {"accept", "*/*"}};
    ASSERT_TRUE(split_target(request));
    EXPECT_EQ(request.target, "/api/boards?board=a");
    EXPECT_EQ(request.scheme, "http");
    EXPECT_THAT(request.segments, ElementsAre("api", "boards"));
    EXPECT_THAT(request.query, ElementsAre(Pair("board", "a")));
    EXPECT_THAT(request.headers, ElementsAre(Pair("host", "Lab.example:8080"), Pair("accept", "*/*")));
}

TEST(HttpTarget, AbsoluteFormWithoutPath_IsTheRoot) {
    auto bare = request_to("https://lab.example");
    ASSERT_TRUE(split_target(bare));
    EXPECT_EQ(bare.target, "/");
    EXPECT_FALSE(bare.has_header("host")) << "HTTP/1.1 must send one all the same";
    auto query = request_to("http://lab.example?code=x");
    query.http_1_0 = true;
    ASSERT_TRUE(split_target(query));
    EXPECT_EQ(query.target, "/?code=x");
    EXPECT_EQ(query.header("host"), "lab.example");
}

TEST(HttpTarget, Asterisk_IsOfOptionsOnly) {
    for (const char* target : {"*", "http://lab.example"}) {
        auto options = request_to(target);
        options.method = "OPTIONS";
        EXPECT_TRUE(split_target(options));
        EXPECT_TRUE(options.is_asterisk()) << target;
    }
    auto other = request_to("*");
    other.method = "GET";
    EXPECT_FALSE(split_target(other));
}

class PathTrick : public testing::TestWithParam<const char*> {};

TEST_P(PathTrick, IsNoTarget) {
    auto request = request_to(GetParam());
    EXPECT_FALSE(split_target(request));
}

INSTANTIATE_TEST_SUITE_P(HttpTarget, PathTrick,
                         testing::Values("", "api", "http:///api", "http://", "http://me@other/api",
                                         "ftp://other/api", "http://other/../etc", "http:/api", "*",
                                         "/../etc/passwd", "/a/../b", "/a/./b", "/%2e%2e/etc",
                                         "/%2E%2E%2Fetc", "/a%2fb", "/a%5cb", "/a\\b", "/%00", "/a%0d%0ab",
                                         "/%", "/%4", "/%zz", "/a?x=%1", "/a?x=%00"));

bool accepts(const char* text) {
    Request request;
    request.headers = {{"accept-encoding", text}};
    return accepts_gzip(request);
}

TEST(HttpGzip, QualityZero_IsARefusal) {
    EXPECT_TRUE(accepts("deflate, gzip"));
    EXPECT_TRUE(accepts("gzip;q=0.5"));
    EXPECT_TRUE(accepts("*"));
    EXPECT_FALSE(accepts("gzip;q=0"));
    EXPECT_FALSE(accepts("gzip;q=0.00, br"));
    EXPECT_FALSE(accepts("br"));
    EXPECT_FALSE(accepts("identity"));
    EXPECT_FALSE(accepts("identity;q=0.5, *;q=0"));
    EXPECT_FALSE(accepts(""));
}

TEST(HttpGzip, NamedItself_CountsBeforeAnyOther) {
    EXPECT_TRUE(accepts("*;q=0, gzip"));
    EXPECT_FALSE(accepts("*, gzip;q=0"));
    EXPECT_TRUE(accepts("\tGZIP ; Q=1"));
    EXPECT_FALSE(accepts("gzip;Q=0"));
    EXPECT_FALSE(accepts(" ,;, \t"));
}

TEST(HttpGzip, Text_ComesBackAsItWas) {
    std::string text;
    for (int i = 0; i < 5000; ++i)
        text += "line " + std::to_string(i) + "\n";
    const auto small = compress(text);
    EXPECT_LT(small.size(), text.size() / 3);
    EXPECT_EQ(decompress(small), text);
}

TEST(HttpHead, OfNotModified_HasNoLengthAndNoType) {
    Response response;
    response.status = 304;
    EXPECT_EQ(head_text(response, true, false), "HTTP/1.1 304 Not Modified\r\n\r\n");
}

}  // namespace
}  // namespace asip::gateway::http
