// SPDX-License-Identifier: Apache-2.0
// Bodies that come slowly, or not to their end.
#include <gmock/gmock.h>

#include <thread>

#include "running_gateway.hpp"

namespace asip::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;
using testing::HasSubstr;

constexpr milliseconds kBodyTime{1000};
constexpr milliseconds kClosedBy{6000};  // on a machine that does much else

class GatewaySlowBody : public GatewayTest {
  protected:
    GatewaySlowBody()
        : GatewayTest({"--config", settings_file("body-time = 1s\nheader-time = 30s\nidle-time = 30s\n")}) {
        announce("uno1");
    }
    static std::string head(const std::string& more) {
        return "POST /api/boards/uno1/services/servo/commands/write?deadline_ms=50 HTTP/1.1\r\n"
               "Host: localhost\r\nContent-Type: application/json\r\n" +
               more + "\r\n\r\n";
    }
    bool nothing_was_sent() const { return probe_.count("asip/uno1/servo/in") == 0; }
    void expect_timeout(Wire& wire, const std::string& what) {
        const auto answer = read_answer(wire, kClosedBy);
        EXPECT_EQ(answer.status, 408) << what;
        EXPECT_EQ(answer.headers.count("content-length"), 1u) << what;
        EXPECT_THAT(answer.detail(), HasSubstr("took too long")) << what;
        EXPECT_TRUE(wire.closed()) << what;
    }
};

TEST_F(GatewaySlowBody, OneByteAtATimeWithinTheTime_IsServed) {
    const std::string sized = "[0,90]";
    const std::string chunked = "2\r\n[0\r\n4\r\n,90]\r\n0\r\n\r\n";
    std::size_t commands = 0;
    for (const auto& [header, body] :
         {std::pair("Content-Length: 6", sized), std::pair("Transfer-Encoding: chunked", chunked)}) {
        Wire wire(port());
        wire.send(head(header));
        for (const char c : body) {
            EXPECT_EQ(wire.waiting(), "") << "answered before the body was there";
            wire.send({&c, 1});
            std::this_thread::sleep_for(milliseconds(10));
        }
        EXPECT_EQ(read_answer(wire).status, 504) << "sent, and there is no agent";
        ++commands;
        EXPECT_TRUE(wait_until([&] { return probe_.count("asip/uno1/servo/in") == commands; }));
        EXPECT_THAT(probe_.last("asip/uno1/servo/in").value_or(""), HasSubstr(R"("write":[0,90])"));
    }
}

TEST_F(GatewaySlowBody, StopsInTheMiddle_Is408AndOthersAreServedMeanwhile) {
    const auto begin = steady_clock::now();
    std::vector<Wire> stopped;
    for (int i = 0; i < 100; ++i) {
        stopped.emplace_back(port());
        stopped.back().send(i % 2 == 0 ? head("Content-Length: 6") + "[0,"
                                       : head("Transfer-Encoding: chunked") + "6\r\n[0,");
    }
    EXPECT_TRUE(alive());
    EXPECT_EQ(ask("/api/boards/uno1").status, 200);
    for (auto& wire : stopped)
        expect_timeout(wire, "stopped");
    EXPECT_GE(steady_clock::now() - begin, kBodyTime) << "they have all of the time";
    EXPECT_TRUE(nothing_was_sent());
    EXPECT_TRUE(wait_until([&] {
        return ask("/metrics").body.find("\nasip_gateway_http_connections 1\n") != std::string::npos;
    })) << ask("/metrics").body;
}

TEST_F(GatewaySlowBody, OneByteNowAndThen_DoesNotGiveMoreTime) {
    Wire wire(port());
    const auto begin = steady_clock::now();
    wire.send(head("Content-Length: 1000"));
    HttpAnswer answer;
    while (answer.status == 0 && steady_clock::now() - begin < kClosedBy) {
        wire.send(" ");
        answer = read_answer(wire, milliseconds(100));
    }
    EXPECT_EQ(answer.status, 408);
    EXPECT_GE(steady_clock::now() - begin, kBodyTime);
    EXPECT_TRUE(wire.closed());
    EXPECT_TRUE(nothing_was_sent());
}

TEST_F(GatewaySlowBody, AskedToGoOnAndSendsNothing_Is408) {
    Wire wire(port());
    wire.send(head("Content-Length: 6\r\nExpect: 100-continue"));
    EXPECT_EQ(wire.read_until("\r\n\r\n"), "HTTP/1.1 100 Continue\r\n\r\n");
    expect_timeout(wire, "never goes on");
    EXPECT_TRUE(nothing_was_sent());
}

TEST_F(GatewaySlowBody, GoneInTheMiddle_NothingOfItIsExecuted) {
    for (const std::string body : {"", "[", "[0,90"}) {
        Wire wire(port());
        wire.send(head("Content-Length: 6") + body);
    }
    EXPECT_TRUE(alive());
    EXPECT_TRUE(wait_until([&] {
        return ask("/metrics").body.find("\nasip_gateway_http_connections 1\n") != std::string::npos;
    })) << ask("/metrics").body;
    EXPECT_TRUE(nothing_was_sent());
}

}  // namespace
}  // namespace asip::test
