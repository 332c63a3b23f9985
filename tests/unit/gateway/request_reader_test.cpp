// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/request_reader.hpp"

#include <gmock/gmock.h>

namespace asip::gateway::http {
namespace {

RequestReader reader() {
    return RequestReader({.header_bytes = 512, .body_bytes = 64});
}

// What a connection does with bytes as they come; what is left over is behind the request.
std::string feed_all(RequestReader& into, std::string bytes) {
    while (!bytes.empty() && !into.done() && !into.error()) {
        const auto used = into.feed(bytes);
        bytes.erase(0, used);
        if (used == 0) break;
    }
    return bytes;
}

int status_of(const std::string& bytes) {
    auto into = reader();
    feed_all(into, bytes);
    return into.error() ? into.error()->status : into.done() ? 200 : 0;
}

TEST(HttpRequest, InOnePiece_IsRead) {
    auto into = reader();
    feed_all(into,
             "POST /api/boards/uno1/raw?deadline_ms=50 HTTP/1.1\r\nHost: a\r\nX-Thing: 7\r\nContent-Length: "
             "2\r\n\r\n{}");
    ASSERT_TRUE(into.done());
    const auto request = into.take();
    EXPECT_EQ(request.method, "POST");
    EXPECT_EQ(request.header("x-thing"), "7");
    EXPECT_EQ(request.body, "{}");
    EXPECT_EQ(*request.parameter("deadline_ms"), "50");
    EXPECT_TRUE(request.keep_alive);
}

TEST(HttpRequest, ByteByByte_IsRead) {
    auto into = reader();
    std::string held;
    for (const char c : std::string("GET /a HTTP/1.1\r\nHost: a\r\n\r\n")) {
        ASSERT_FALSE(into.done());
        held += c;
        held.erase(0, into.feed(held));
        ASSERT_FALSE(into.error());
    }
    ASSERT_TRUE(into.done());
    EXPECT_EQ(into.take().target, "/a");
}

TEST(HttpRequest, TwoInOnePiece_TheSecondIsLeft) {
    auto into = reader();
    const std::string second = "GET /b HTTP/1.1\r\nHost: a\r\n\r\n";
    EXPECT_EQ(feed_all(into, "GET /a HTTP/1.1\r\nHost: a\r\n\r\n" + second), second);
    EXPECT_TRUE(into.done());
}

TEST(HttpRequest, ChunkedBody_IsPutTogether) {
    auto into = reader();
    feed_all(
        into,
        "POST /a HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n3\r\n[1,\r\n2\r\n2]\r\n0\r\n\r\n");
    ASSERT_TRUE(into.done());
    EXPECT_EQ(into.take().body, "[1,2]");
}

TEST(HttpRequest, ChunkedBodyByteByByte_IsPutTogether) {
    auto into = reader();
    const std::string text =
        "POST /a HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n3\r\n[1,\r\n2\r\n2]\r\n0\r\n\r\n";
    std::string waiting;
    for (const char c : text) {
        ASSERT_FALSE(into.done());
        waiting += c;
        waiting.erase(0, into.feed(waiting));
        ASSERT_FALSE(into.error());
    }
    ASSERT_TRUE(into.done());
    EXPECT_EQ(into.take().body, "[1,2]");
}

TEST(HttpRequest, FieldsBehindTheBody_AreLeftOut) {
    auto into = reader();
    const std::string text =
        "POST /a HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n2\r\n[]\r\n0\r\nHost: b\r\n"
        "Content-Type: application/json\r\nAuthorization: Bearer x\r\n\r\n";
    const std::string second = "GET /b HTTP/1.1\r\nHost: a\r\n\r\n";
    EXPECT_EQ(feed_all(into, text + second), second);
    ASSERT_TRUE(into.done());
    const auto request = into.take();
    EXPECT_EQ(request.body, "[]");
    EXPECT_EQ(request.header("host"), "a");
    EXPECT_FALSE(request.has_header("content-type"));
    EXPECT_FALSE(request.has_header("authorization"));
}

TEST(HttpRequest, EncodedInAnotherWay_Is501AndItsBodyIsNoSecondRequest) {
    for (const std::string coding :
         {"identity", "xchunked", "gzip, chunked", "chunked, identity", "chunked,"}) {
        EXPECT_EQ(
            status_of("POST /a HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: " + coding + "\r\n\r\n0\r\n\r\n"),
            501)
            << coding;
    }
    EXPECT_EQ(status_of("POST /a HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: Chunked\r\n\r\n0\r\n\r\n"), 200);
}

TEST(HttpRequest, ExpectOfAnOldClient_IsNotAnswered) {
    for (const std::string version : {"1.0", "1.1"}) {
        auto into = reader();
        feed_all(into, "POST /a HTTP/" + version +
                           "\r\nHost: a\r\nExpect: 100-continue\r\nContent-Length: 2\r\n\r\n");
        EXPECT_EQ(into.wants_continue(), version == "1.1");
    }
}

TEST(HttpRequest, BodyBeyondTheLimit_Is413BeforeItIsSent) {
    EXPECT_EQ(status_of("POST /a HTTP/1.1\r\nHost: a\r\nContent-Length: 104857600\r\n\r\n"), 413);
    EXPECT_EQ(status_of("POST /a HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n50\r\n" +
                        std::string(80, 'x') + "\r\n0\r\n\r\n"),
              413);
}

TEST(HttpRequest, HeadBeyondTheLimit_Is431) {
    EXPECT_EQ(status_of("GET /a HTTP/1.1\r\nX: " + std::string(600, 'x') + "\r\n\r\n"), 431);
    EXPECT_EQ(status_of("GET /" + std::string(600, 'x') + " HTTP/1.1\r\n\r\n"), 431);
}

class Broken : public testing::TestWithParam<const char*> {};

TEST_P(Broken, IsRefused) {
    EXPECT_EQ(status_of(GetParam()), 400);
}

INSTANTIATE_TEST_SUITE_P(
    HttpRequest, Broken,
    testing::Values("nonsense\r\n\r\n", "GET /a HTTP/1.1\r\nHost a\r\n\r\n", "GET /a HTTP/1.1\r\n: a\r\n\r\n",
                    "GET /a HTTP/1.1\r\nA\x01: a\r\n\r\n", "POST /a HTTP/1.1\r\nContent-Length: -1\r\n\r\n",
                    "POST /a HTTP/1.1\r\nContent-Length: x\r\n\r\n",
                    "POST /a HTTP/1.1\r\nContent-Length: 99999999999999999999999\r\n\r\n",
                    "POST /a HTTP/1.1\r\nContent-Length: 2\r\nContent-Length: 3\r\n\r\n{}",
                    "POST /a HTTP/1.1\r\nContent-Length: 2\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
                    "POST /a HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n[]\r\n",
                    "POST /a HTTP/1.0\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
                    "GET /a HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n"));

TEST(HttpRequest, OtherVersion_Is505OrRefused) {
    EXPECT_THAT(status_of("GET /a HTTP/2.0\r\n\r\n"), testing::AnyOf(400, 505));
    EXPECT_THAT(status_of("GET /a b HTTP/1.1\r\n\r\n"), testing::AnyOf(400, 505));
}

}  // namespace
}  // namespace asip::gateway::http
