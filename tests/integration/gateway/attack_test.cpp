// SPDX-License-Identifier: Apache-2.0
// What a stranger may send: the gateway answers or closes, lives on, and serves the others meanwhile.
#include <gmock/gmock.h>
#include <sys/socket.h>

#include "running_gateway.hpp"

namespace asip::test {
namespace {

using testing::AnyOf;
using testing::HasSubstr;

class GatewayAttack : public GatewayTest {
  protected:
    GatewayAttack()
        : GatewayTest(
              {"--config",
               settings_file("header-time = 1s\nidle-time = 2s\nmax-connections-per-address = 15000\n")}) {}
};

TEST_F(GatewayAttack, ForeignHost_Is421) {
    EXPECT_EQ(get(port(), "/api/boards", {{"Host", "evil.example"}}).status, 421);
    EXPECT_EQ(get(port(), "/", {{"Host", "evil.example"}}).status, 421) << "not even the page";
    EXPECT_EQ(get(port(), "/metrics", {{"Host", "evil.example"}}).status, 421);
    EXPECT_EQ(get(port(), "/api/boards", {{"Host", "127.0.0.1"}}).status, 200);
}

TEST_F(GatewayAttack, RequestsThatChangeNothing_LeaveNoLineInTheLog) {
    for (int i = 0; i < 10; ++i) {
        EXPECT_EQ(request(port(), "DELETE", "/api/session", "").status, 204);
        post(port(), "/api/codes", "{}");
        for (const char* target : {"/api/boards/nothing/values", "/things/nothing/properties/x"})
            EXPECT_EQ(request(port(), "PUT", target, "{}", {{"Content-Type", "application/json"}}).status,
                      404);
    }
    EXPECT_EQ(request(port(), "DELETE", "/api/dashboards/nothing", "").status, 404);
    ASSERT_TRUE(gateway_.process().wait_for_errors("target=/api/dashboards/nothing"));
    for (const char* target : {"/api/session", "/api/codes", "/api/boards/nothing/values", "/things/nothing"})
        EXPECT_THAT(gateway_.process().errors(), testing::Not(HasSubstr(target)));
}

TEST_F(GatewayAttack, PageOfAnotherOrigin_SendsNothing) {
    announce("uno1");
    const std::string command = "/api/boards/uno1/services/servo/commands/write";
    EXPECT_EQ(post(port(), command, "[0,90]", {{"Origin", "http://evil.example"}}).status, 403);
    EXPECT_EQ(post(port(), "/api/stop", "{}", {{"Origin", "http://evil.example"}}).status, 403);
    EXPECT_EQ(post(port(), command, "[0,90]", {{"Content-Type", "text/plain"}}).status, 415);
    EXPECT_EQ(request(port(), "DELETE", "/api/boards/uno1", "", {{"Origin", "null"}}).status, 403);
    EXPECT_EQ(Socket(port(), {{"Origin", "http://evil.example"}}).status(), 403);
    EXPECT_EQ(probe_.count("asip/uno1/servo/in"), 0u);
    const auto plain = get(port(), "/api/boards", {{"Origin", "http://evil.example"}});
    EXPECT_EQ(plain.headers.count("access-control-allow-origin"), 0u) << "a browser keeps it from the page";
    const auto preflight =
        request(port(), "OPTIONS", command, "",
                {{"Origin", "http://evil.example"}, {"Access-Control-Request-Method", "POST"}});
    EXPECT_EQ(preflight.headers.count("access-control-allow-origin"), 0u);
    EXPECT_EQ(preflight.headers.count("access-control-allow-methods"), 0u);
}

TEST_F(GatewayAttack, BodyOfAHundredMegabytes_Is413BeforeItIsRead) {
    Wire wire(port());
    wire.send(
        "POST /api/stop HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
        "Content-Length: 104857600\r\n\r\n");
    EXPECT_EQ(read_answer(wire).status, 413);
    Wire chunked(port());
    chunked.send("POST /api/stop HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n");
    const std::string piece = "10000\r\n" + std::string(0x10000, 'x') + "\r\n";
    for (int i = 0; i < 1600 && chunked.send(piece); ++i) {
    }
    EXPECT_LT(gateway_.process().resident_bytes(), memory_limit(60u << 20));
    EXPECT_TRUE(alive());
}

TEST_F(GatewayAttack, SlowHeads_AreClosedAndOthersServed) {
    std::vector<Wire> slow;
    for (int i = 0; i < 200; ++i) {
        slow.emplace_back(port());
        slow.back().send("GET /api/boards HTTP/1.1\r\nHo");
    }
    EXPECT_TRUE(alive());
    for (auto& wire : slow) {
        wire.send("s");
        EXPECT_TRUE(wire.closed(std::chrono::seconds(6)));
    }
}

TEST_F(GatewayAttack, SaysNothingAtAll_IsClosed) {
    Wire silent(port());
    EXPECT_TRUE(silent.closed(std::chrono::seconds(5)));
    Wire idle(port());
    idle.send("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_EQ(read_answer(idle).status, 200);
    EXPECT_TRUE(idle.closed(std::chrono::seconds(6)));
}

TEST_F(GatewayAttack, Smuggling_IsRefused) {
    Wire both(port());
    both.send(
        "POST /api/codes HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: "
        "40\r\n"
        "Transfer-Encoding: chunked\r\n\r\n0\r\n\r\nGET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_EQ(read_answer(both).status, 400);
    EXPECT_TRUE(both.closed());
    Wire twice(port());
    twice.send("GET / HTTP/1.1\r\nHost: localhost\r\nHost: evil.example\r\n\r\n");
    const auto refused = read_answer(twice);
    EXPECT_EQ(refused.status, 400);
    EXPECT_EQ(refused.detail(), "more than one Host");
    EXPECT_TRUE(twice.closed());
    EXPECT_EQ(twice.waiting(), "") << "nothing behind what Content-Length says";
}

TEST_F(GatewayAttack, Pipelined_AreAnsweredInOrderAndHeadHasNoBody) {
    Wire wire(port());
    std::string many;
    for (int i = 0; i < 50; ++i)
        many += "GET /api/models/" + std::string(i % 2 == 0 ? "servo" : "nothing") +
                " HTTP/1.1\r\nHost: localhost\r\n\r\n";
    wire.send(many + "HEAD /api/models/servo HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    for (int i = 0; i < 50; ++i)
        EXPECT_EQ(read_answer(wire).status, i % 2 == 0 ? 200 : 404) << i;
    const auto size = std::to_string(ask("/api/models/servo").body.size());
    EXPECT_THAT(wire.read_until("\r\n\r\n"), HasSubstr("\r\nContent-Length: " + size + "\r\n"));
    EXPECT_TRUE(wire.closed());
    EXPECT_EQ(wire.waiting(), "") << "a body behind HEAD";
}

TEST_F(GatewayAttack, BrokenWebSocketFrames_EndThatConnectionOnly) {
    struct Case {
        const char* what;
        std::vector<std::pair<unsigned char, std::string>> frames;
        bool masked;
        std::vector<int> codes;
    };
    const std::vector<Case> cases{
        {"not masked", {{0x81, "{}"}}, false, {1002}},
        {"reserved bit", {{0xC1, "{}"}}, true, {1002}},
        {"unknown operation", {{0x83, "x"}}, true, {1002}},
        {"fragmented ping", {{0x09, "x"}}, true, {1002}},
        {"long ping", {{0x89, std::string(126, 'x')}}, true, {1002}},
        {"continuation of nothing", {{0x80, "x"}}, true, {1002}},
        {"two beginnings", {{0x01, "a"}, {0x81, "b"}}, true, {1002}},
        {"not UTF-8", {{0x81, "\xff\xfe"}}, true, {1007}},
        {"binary", {{0x82, "{}"}}, true, {1003}},
        {"close of one byte", {{0x88, "x"}}, true, {1002}},
        {"close with a code that is none", {{0x88, std::string("\x03\xe7", 2)}}, true, {1002}},
    };
    Socket other(port());
    ASSERT_EQ(other.status(), 101);
    for (const auto& [what, frames, masked, codes] : cases) {
        Socket socket(port());
        ASSERT_EQ(socket.status(), 101) << what;
        for (const auto& [first, payload] : frames)
            socket.frame(first, payload, masked);
        EXPECT_THAT(socket.close_code(), AnyOf(0, codes[0])) << what;
    }
    other.send(R"({"subscribe":"*/*","ref":1})");
    EXPECT_EQ(other.message(), R"({"ref":1,"ok":true})");
}

TEST_F(GatewayAttack, WebSocketMessageBeyondTheLimit_Is1009) {
    Socket socket(port());
    socket.frame(0x01, std::string(60'000, 'x'));
    socket.frame(0x80, std::string(60'000, 'x'));
    EXPECT_THAT(socket.close_code(), AnyOf(0, 1009));
    Socket long_frame(port());
    long_frame.wire().send(std::string("\x81\xff\x7f\xff\xff\xff\xff\xff\xff\xff\1\2\3\4", 14));
    EXPECT_THAT(long_frame.close_code(), AnyOf(0, 1009, 1002));
    EXPECT_TRUE(alive());
}

TEST_F(GatewayAttack, HalfClosedByTheClient_IsAnsweredOrClosedAndNothingStaysOpen) {
    announce("uno1");
    for (const char* request :
         {"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n",
          "GET /api/events HTTP/1.1\r\nHost: localhost\r\n\r\n", "GET /healthz HTTP/1.1\r\nHo",
          "POST /api/stop HTTP/1.1\r\nHost: localhost\r\nContent-Length: 10\r\n\r\n{"}) {
        Wire wire(port());
        wire.send(request);
        shutdown(wire.socket(), SHUT_WR);
        EXPECT_TRUE(wire.closed()) << request;
    }
    Wire whole(port());
    whole.send("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
    shutdown(whole.socket(), SHUT_WR);
    EXPECT_EQ(read_answer(whole).status, 200);
    Socket socket(port());
    ASSERT_EQ(socket.status(), 101);
    socket.send(R"({"subscribe":"*/*","ref":1})");
    EXPECT_EQ(socket.message(), R"({"ref":1,"ok":true})");
    shutdown(socket.wire().socket(), SHUT_WR);
    EXPECT_TRUE(wait_until([&] {
        const auto text = ask("/metrics").body;
        return text.find("\nasip_gateway_http_connections 1\n") != std::string::npos;
    })) << ask("/metrics").body;
}

TEST_F(GatewayAttack, WhatIsNoUtf8_IsRefusedInWordsThatAre) {
    announce("uno1");
    const std::string command = "/api/boards/uno1/services/servo/commands/write";
    for (const std::string target :
         {"/api/boards/%ff%fe", "/api/boards/\xff\xfe", "/api/boards/uno1/services/%c3%28", "/api/models/%80",
          "/api/boards?board=%ff", "/api/boards?%ff=1", "/api/boards/%ed%a0%80/history", "/%c0%ae%c0%ae/"}) {
        const auto answer = ask(target);
        EXPECT_THAT(answer.status, AnyOf(200, 400, 404)) << target;
        EXPECT_FALSE(answer.json().is_discarded()) << target << ": " << answer.body;
    }
    for (const std::string body : {"[0,\"\xff\"]", "\xef\xbb\xbf[0,90", "{\"\xc3\x28\":1}"}) {
        const auto answer = post(port(), command, body);
        EXPECT_EQ(answer.status, 400) << body;
        EXPECT_FALSE(answer.json().is_discarded()) << answer.body;
    }
    EXPECT_EQ(post(port(), command, "[0,90]", {{"Idempotency-Key", "\xff"}}).status, 400);
    EXPECT_EQ(probe_.count("asip/uno1/servo/in"), 0u);
    EXPECT_TRUE(alive());
}

TEST_F(GatewayAttack, SlowReader_IsNotClosedAndSlowsNobody) {
    announce("uno1");
    EventStream slow(port(), "/api/boards/uno1/services/distance/stream");
    ASSERT_EQ(slow.head().status, 200);
    EventStream quick(port(), "/api/boards/uno1/services/distance/stream");
    ASSERT_EQ(quick.next("snapshot-end").kind, "snapshot-end");
    const std::string filler(2000, 'x');
    constexpr int kValues = 5000;  // 10 MB: more than any buffer on the way
    for (int i = 1; i <= kValues; ++i) {
        probe_.publish("asip/uno1/distance/out",
                       R"({"n":)" + std::to_string(i) + R"(,"x":")" + filler + "\"}", false, 0);
        if (i % 50 == 0) {
            EventStream::Event event;
            do {
                event = quick.next("value");
            } while (!event.kind.empty() &&
                     event.data.find("\"n\":" + std::to_string(i) + ",") == std::string::npos);
            ASSERT_FALSE(event.kind.empty()) << "the quick reader waits at " << i;
        }
    }
    EXPECT_LT(gateway_.process().resident_bytes(), memory_limit(100u << 20));
    std::uint64_t seen = 0, left_out = 0, last = 0;
    while (last < kValues) {
        const auto event = slow.next("value");
        ASSERT_FALSE(event.kind.empty()) << "still connected, and sent the newest";
        const auto data = nlohmann::json::parse(event.data);
        last = data["value"]["n"];
        ++seen;
        left_out += data.value("left_out", 0);
    }
    EXPECT_GT(left_out, 0u);
    EXPECT_EQ(seen + left_out, static_cast<std::uint64_t>(kValues));
}

TEST(GatewayOrigins, OneThatIsAllowed_MayCallAndIsNamedAloneInTheAnswer) {
    MosquittoBroker broker;
    RunningGateway gateway(broker.address(), {"--allow-origin", "https://dash.example"});
    ASSERT_TRUE(gateway.ready());
    const Headers dash{{"Origin", "https://dash.example"}};
    const auto read = get(gateway.port(), "/api/boards", dash);
    EXPECT_EQ(read.headers.at("access-control-allow-origin"), "https://dash.example");
    EXPECT_EQ(read.headers.count("access-control-allow-credentials"), 0u) << "no cookie of ours goes along";
    EXPECT_EQ(post(gateway.port(), "/api/stop", "{}", dash).status, 200);
    for (const std::string origin : {"https://dash.example.evil.example", "http://dash.example", "null"}) {
        EXPECT_EQ(post(gateway.port(), "/api/stop", "{}", {{"Origin", origin}}).status, 403) << origin;
        EXPECT_EQ(get(gateway.port(), "/api/boards", {{"Origin", origin}})
                      .headers.count("access-control-allow-origin"),
                  0u);
    }
}

TEST(GatewayBinding, Start_LogsWhatThisMachineMayDoWithoutAToken) {
    MosquittoBroker broker;
    RunningGateway open(broker.address());
    EXPECT_THAT(open.process().errors(), HasSubstr("from this machine=admin"));
    RunningGateway closed(broker.address(), {"--trusted-proxy"});
    EXPECT_THAT(closed.process().errors(), HasSubstr("from this machine=none"));
    EXPECT_EQ(get(closed.port(), "/api/boards").status, 401) << "a proxy's clients are not this machine's";
}

TEST(GatewayBinding, ProxyThatItWasNotToldOf_IsRefusedAndSaysWhatToDo) {
    MosquittoBroker broker;
    RunningGateway gateway(broker.address());
    ASSERT_TRUE(gateway.ready());
    const Headers forwarded{{"X-Forwarded-For", "192.0.2.7"}};
    for (const char* target : {"/", "/api/boards", "/metrics"}) {
        const auto refused = get(gateway.port(), target, forwarded);
        EXPECT_EQ(refused.status, 403) << target;
        EXPECT_THAT(refused.detail(), HasSubstr("--trusted-proxy")) << target;
    }
    EXPECT_EQ(post(gateway.port(), "/api/stop", "{}", forwarded).status, 403);
    EXPECT_EQ(get(gateway.port(), "/api/boards").status, 200);
}

TEST(GatewayBinding, TrustedProxy_ItsClientsHaveLimitsOfTheirOwn) {
    MosquittoBroker broker;
    RunningGateway gateway(broker.address(),
                           {"--trusted-proxy", "--anonymous", "viewer", "--config",
                            settings_file("max-streams = 2\nmax-connections-per-address = 3\n")});
    const auto as = [](const std::string& address) { return Headers{{"X-Forwarded-For", address}}; };
    ASSERT_TRUE(gateway.ready());
    std::vector<EventStream> streams;
    for (const char* address : {"192.0.2.7", "192.0.2.7", "192.0.2.8", "2001:db8::1", "2001:db8::2"}) {
        streams.emplace_back(gateway.port(), "/api/events", as(address));
        EXPECT_EQ(streams.back().head().status, 200) << address;
    }
    EXPECT_EQ(get(gateway.port(), "/api/events", as("192.0.2.7")).status, 429);
    EXPECT_EQ(get(gateway.port(), "/api/events", as("9.9.9.9, 192.0.2.7")).status, 429)
        << "what the client wrote before it counts for nothing";
    EXPECT_EQ(get(gateway.port(), "/api/events", as("2001:db8::3")).status, 429) << "of one /64";
    EXPECT_EQ(get(gateway.port(), "/api/boards", as("192.0.2.7")).status, 200);
}

TEST(GatewayBinding, BasePathOfAProxy_PageAndApiAreBelowIt) {
    MosquittoBroker broker;
    RunningGateway gateway(broker.address(), {"--base-path", "/asip"});
    EXPECT_EQ(get(gateway.port(), "/asip/").status, 200);
    EXPECT_EQ(get(gateway.port(), "/asip/main.js").status, 200);
    EXPECT_EQ(get(gateway.port(), "/asip/healthz").status, 200);
    const auto bare = get(gateway.port(), "/asip?code=x");
    EXPECT_EQ(bare.status, 308);
    EXPECT_EQ(bare.headers.at("location"), "/asip/?code=x");
    EXPECT_EQ(get(gateway.port(), "/asip/api/").status, 404);
    EXPECT_EQ(get(gateway.port(), "/").status, 404);
    EXPECT_EQ(get(gateway.port(), "/healthz").status, 404);
}

TEST(GatewayBinding, ReachableByOthersAndNothingChosen_DoesNotStart) {
    const auto refused = run({ASIP_PROGRAMS "/asip-gateway", "--http", "0.0.0.0:0"});
    EXPECT_EQ(refused.status, 2);
    EXPECT_THAT(refused.errors, HasSubstr("--tokens"));
    EXPECT_THAT(refused.errors, HasSubstr("--anonymous"));
}

TEST(GatewayBinding, UnixSocket_ServesAndKnowsNobody) {
    MosquittoBroker broker;
    TempDir folder;
    const auto path = folder.file("gateway.sock");
    ChildProcess gateway(
        {ASIP_PROGRAMS "/asip-gateway", "--broker", broker.address(), "--http", "unix:" + path});
    ASSERT_TRUE(gateway.wait_for_errors("listening"));
    const auto health = run({"curl", "-s", "--unix-socket", path, "http://localhost/healthz"});
    EXPECT_EQ(health.output, R"({"status":"ok"})");
    const auto boards = run({"curl", "-s", "-o", "/dev/null", "-w", "%{http_code}", "--unix-socket", path,
                             "http://localhost/api/boards"});
    EXPECT_EQ(boards.output, "401") << "a proxy's clients are not this machine's";
}

}  // namespace
}  // namespace asip::test
