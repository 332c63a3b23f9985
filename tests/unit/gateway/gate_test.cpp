// SPDX-License-Identifier: Apache-2.0
#include "gateway/auth/gate.hpp"

#include <gmock/gmock.h>

#include "clock.hpp"

namespace asip::gateway {
namespace {

class GateTest : public testing::Test {
  protected:
    GateTest() {
        options_.hosts = {"localhost", "lab.example"};
        options_.anonymous.name = "nobody";
        options_.allowed_origins = {"https://dash.example"};
    }
    Gate make() {
        Gate gate(options_, [this](std::size_t bytes) {
            return std::to_string(bytes) + "-" + std::to_string(++drawn_);
        });
        auto tokens = Tokens::parse("viewer hall " + hash_of("see") + "\noperator anna " + hash_of("do") +
                                    "\nadmin old " + hash_of("past") + " until=2023-11-14T22:13:20.000Z\n");
        gate.set_tokens(*tokens);
        return gate;
    }
    static http::Request get(std::vector<std::pair<std::string, std::string>> headers = {}) {
        http::Request request;
        request.method = "GET";
        request.headers = std::move(headers);
        if (!request.has_header("host")) request.headers.emplace_back("host", "localhost:8080");
        request.peer.address = "10.0.0.7";
        return request;
    }
    static http::Request post(std::vector<std::pair<std::string, std::string>> headers = {}) {
        auto request = get(std::move(headers));
        request.method = "POST";
        if (!request.has_header("content-type"))
            request.headers.emplace_back("content-type", "application/json");
        return request;
    }
    int status(const http::Request& request) {
        const auto principal = make().admit(request, at(0ms));
        return principal ? 200 : principal.error().status;
    }
    Role role(const http::Request& request) {
        const auto principal = make().admit(request, at(0ms));
        return principal ? principal->rights.role : Role::kNone;
    }

    Gate::Options options_;
    int drawn_ = 0;
};

TEST_F(GateTest, ForeignHost_IsMisdirected) {
    EXPECT_EQ(status(get({{"host", "evil.example"}})), 421);
    EXPECT_EQ(status(get({{"host", "evil.example:8080"}})), 421);
    EXPECT_EQ(status(get({{"host", "localhost.evil.example"}})), 421);
    EXPECT_EQ(status(get({{"host", "xlab.example"}})), 421);
    EXPECT_EQ(status(get({{"host", ""}})), 400);
    EXPECT_EQ(status(get({{"host", "LAB.example:80"}})), 200);
    EXPECT_EQ(status(get({{"host", "192.168.1.7:8080"}})), 200) << "an address cannot be made to lead here";
    EXPECT_EQ(status(get({{"host", "[fe80::1]:8080"}})), 200);
}

TEST_F(GateTest, AbsoluteTargetOfAnotherScheme_IsMisdirected) {
    auto request = get();
    request.scheme = "https";
    EXPECT_EQ(status(request), 421);
    options_.behind_proxy = true;
    EXPECT_EQ(status(request), 200) << "TLS may end at the proxy";
    options_.behind_proxy = false;
    request.peer.secure = true;
    EXPECT_EQ(status(request), 200);
    request.scheme = "http";
    EXPECT_EQ(status(request), 421);
}

TEST_F(GateTest, ForeignOrigin_MayNotChangeAnything) {
    EXPECT_EQ(status(post({{"origin", "http://evil.example"}})), 403);
    EXPECT_EQ(status(post({{"origin", "null"}})), 403);
    EXPECT_EQ(status(post({{"origin", "http://localhost:9999"}})), 403) << "another port is another origin";
    EXPECT_EQ(status(post({{"origin", "https://localhost:8080"}})), 403) << "another scheme, too";
    EXPECT_EQ(status(post({{"origin", "http://localhost:8080.evil.example"}})), 403);
    EXPECT_EQ(status(post({{"sec-fetch-site", "cross-site"}})), 403);
    EXPECT_EQ(status(post({{"sec-fetch-site", "same-site"}})), 403);
    EXPECT_EQ(status(post({{"origin", "http://localhost:8080"}, {"sec-fetch-site", "same-origin"}})), 200);
    EXPECT_EQ(status(post()), 200) << "no browser";
    EXPECT_EQ(status(post({{"origin", "https://dash.example"}, {"sec-fetch-site", "cross-site"}})), 200);
    auto remove = get({{"origin", "http://evil.example"}});
    remove.method = "DELETE";
    EXPECT_EQ(status(remove), 403);
}

TEST_F(GateTest, ForeignOriginsWebSocket_IsRefused) {
    EXPECT_EQ(status(get({{"upgrade", "websocket"}, {"origin", "http://evil.example"}})), 403);
    EXPECT_EQ(status(get({{"upgrade", "WebSocket"}, {"origin", "http://evil.example"}})), 403);
    EXPECT_EQ(status(get({{"upgrade", "websocket"}, {"origin", "http://localhost:8080"}})), 200);
}

TEST_F(GateTest, ChangeWithoutJsonType_Is415) {
    EXPECT_EQ(status(post({{"content-type", ""}})), 415);
    EXPECT_EQ(status(post({{"content-type", "text/plain"}})), 415) << "what a foreign form could send";
    EXPECT_EQ(status(post({{"content-type", "application/x-www-form-urlencoded"}})), 415);
    EXPECT_EQ(status(post({{"content-type", "text/plain; application/json"}})), 415);
    EXPECT_EQ(status(post({{"content-type", "Application/JSON; charset=utf-8"}})), 200);
}

TEST_F(GateTest, Token_GivesItsRole) {
    EXPECT_EQ(role(get({{"authorization", "Bearer see"}})), Role::kViewer);
    EXPECT_EQ(role(get({{"authorization", "bearer do"}})), Role::kOperator);
    EXPECT_EQ(status(get({{"authorization", "Bearer sees"}})), 401);
    EXPECT_EQ(status(get({{"authorization", "Bearer "}})), 401);
    EXPECT_EQ(status(get({{"authorization", "Basic see"}})), 401);
    EXPECT_EQ(status(get({{"authorization", "Bearer past"}})), 401) << "expired";
    EXPECT_EQ(role(get()), Role::kNone);
    EXPECT_EQ(role(get({{"upgrade", "websocket"}, {"sec-websocket-protocol", "asip, asip.bearer.do"}})),
              Role::kOperator);
    EXPECT_EQ(role(get({{"sec-websocket-protocol", "asip.bearer.do"}})), Role::kNone)
        << "only for a WebSocket";
}

TEST_F(GateTest, Loopback_OnlyOverTheInterfaceItself) {
    options_.loopback.role = Role::kAdmin;
    auto local = get();
    local.peer.loopback = true;
    EXPECT_EQ(role(local), Role::kAdmin);
    EXPECT_EQ(role(get({{"x-forwarded-for", "127.0.0.1"}})), Role::kNone);
    local.headers.emplace_back("authorization", "Bearer wrong");
    EXPECT_EQ(status(local), 401) << "a wrong token is no token";
}

TEST_F(GateTest, Cookie_OnlyByACodeOnceWithinThirtySeconds) {
    Gate gate = make();
    const auto anna = *gate.tokens().named("anna");
    EXPECT_EQ(gate.admit(get({{"cookie", "asip=forged"}}), at(0ms))->rights.role, Role::kNone);
    const auto code = gate.logins().make_code(anna, at(0ms).time);
    EXPECT_FALSE(gate.logins().redeem(code + "x", at(1s).time));
    const auto cookie = gate.logins().redeem(code, at(1s).time);
    ASSERT_TRUE(cookie);
    EXPECT_FALSE(gate.logins().redeem(code, at(2s).time)) << "once";
    const auto request = get({{"cookie", "theme=dark; asip=" + *cookie}});
    EXPECT_EQ(gate.admit(request, at(2s))->rights.name, "anna");
    EXPECT_EQ(gate.admit(get({{"cookie", "asipx=" + *cookie}}), at(2s))->rights.role, Role::kNone);
    EXPECT_EQ(gate.admit(request, at(13h))->rights.role, Role::kNone) << "a session ends";
    const auto late = gate.logins().make_code(anna, at(0ms).time);
    EXPECT_FALSE(gate.logins().redeem(late, at(30s).time));
}

TEST_F(GateTest, TokenRevoked_ItsCookiesAndStreamsEnd) {
    Gate gate = make();
    const auto code = gate.logins().make_code(*gate.tokens().named("anna"), at(0ms).time);
    const auto cookie = gate.logins().redeem(code, at(0ms).time);
    const auto request = get({{"cookie", "asip=" + *cookie}});
    const auto principal = gate.admit(request, at(0ms));
    ASSERT_TRUE(gate.still_admitted(*principal, at(0ms)));
    gate.set_tokens(*Tokens::parse("viewer hall " + hash_of("see")));
    EXPECT_FALSE(gate.still_admitted(*principal, at(0ms)));
    EXPECT_EQ(gate.admit(request, at(0ms))->rights.role, Role::kNone);
}

TEST_F(GateTest, TokenChangedOrExpired_ItsStreamsEnd) {
    Gate gate = make();
    const auto principal = gate.admit(get({{"authorization", "Bearer do"}}), at(0ms));
    gate.set_tokens(*Tokens::parse("viewer anna " + hash_of("do")));
    EXPECT_FALSE(gate.still_admitted(*principal, at(0ms)));
    gate.set_tokens(*Tokens::parse("admin old " + hash_of("past") + " until=2023-11-14T22:13:30.000Z"));
    const auto old = gate.admit(get({{"authorization", "Bearer past"}}), at(9s));
    ASSERT_TRUE(old);
    EXPECT_TRUE(gate.still_admitted(*old, at(9s)));
    EXPECT_FALSE(gate.still_admitted(*old, at(10s)));
}

}  // namespace
}  // namespace asip::gateway
