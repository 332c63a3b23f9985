// SPDX-License-Identifier: Apache-2.0
#include "gateway/auth/gate.hpp"

#include <gmock/gmock.h>

#include "clock.hpp"
#include "gateway/http/address.hpp"

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

// A name says nothing: the user who had the old token, or signed in by it, is not the one whom the new one is
// for.
TEST_F(GateTest, TokenMadeAnewUnderItsName_RevivesAndKeepsNothingOfTheOldOne) {
    Gate gate = make();
    const auto by_token = gate.admit(get({{"authorization", "Bearer do"}}), at(0ms));
    const auto anna = *gate.tokens().named("anna");
    const auto cookie = *gate.logins().redeem(gate.logins().make_code(anna, at(0ms).time), at(0ms).time);
    const auto unused = gate.logins().make_code(anna, at(0ms).time);
    const auto with_cookie = get({{"cookie", "asip=" + cookie}});
    const auto by_cookie = gate.admit(with_cookie, at(0ms));
    ASSERT_TRUE(by_token && by_cookie);
    ASSERT_EQ(by_cookie->rights.name, "anna");
    const auto expect_over = [&](const char* when) {
        EXPECT_FALSE(gate.still_admitted(*by_token, at(1s))) << when;
        EXPECT_FALSE(gate.still_admitted(*by_cookie, at(1s))) << when;
        EXPECT_EQ(gate.admit(with_cookie, at(1s))->rights.role, Role::kNone) << when;
        EXPECT_FALSE(gate.logins().redeem(unused, at(1s).time)) << when;
    };
    gate.set_tokens(*Tokens::parse("operator anna " + hash_of("another") + "\n"));
    expect_over("replaced by one with the same name and rights");
    EXPECT_TRUE(gate.admit(get({{"authorization", "Bearer another"}}), at(1s)));
    gate.set_tokens(*Tokens::parse(""));
    gate.set_tokens(*Tokens::parse("operator anna " + hash_of("another") + "\n"));
    expect_over("taken out, and made anew");
    gate.set_tokens(*Tokens::parse("operator anna " + hash_of("do") + "\n"));
    EXPECT_EQ(gate.admit(with_cookie, at(1s))->rights.role, Role::kNone)
        << "a backup of the file revives none";
}

// What it opened would go on for as long as the browser keeps it open.
TEST_F(GateTest, SessionThatEnded_ItsStreamsEnd) {
    Gate gate = make();
    const auto sign_in = [&] {
        const auto code = gate.logins().make_code(*gate.tokens().named("anna"), at(0ms).time);
        return *gate.logins().redeem(code, at(0ms).time);
    };
    const auto stay = sign_in(), leave = sign_in();
    const auto staying = gate.admit(get({{"cookie", "asip=" + stay}}), at(0ms));
    const auto leaving = gate.admit(get({{"cookie", "asip=" + leave}}), at(0ms));
    gate.logins().end(leave);
    EXPECT_FALSE(gate.still_admitted(*leaving, at(1s))) << "signed out";
    EXPECT_TRUE(gate.still_admitted(*staying, at(1s)));
    EXPECT_TRUE(gate.still_admitted(*staying, at(12h - 1s)));
    EXPECT_FALSE(gate.still_admitted(*staying, at(12h)));
    EXPECT_EQ(gate.admit(get({{"cookie", "asip=" + stay}}), at(12h))->rights.role, Role::kNone);
}

TEST_F(GateTest, RightsOnSomeServices_AreForNoWholeBoard) {
    for (const char* role : {"operator", "operator+raw", "admin"}) {
        auto rights = *parse_role(role);
        EXPECT_TRUE(rights.may_stop());
        rights.services = {"servo"};
        EXPECT_TRUE(rights.may_command());
        EXPECT_FALSE(rights.may_stop() || rights.may_send_raw() || rights.may_forget()) << role;
    }
}

TEST_F(GateTest, HostWithMoreThanNameAndPort_IsNoHost) {
    for (const char* host : {"[::1].evil.example", "[::1]evil.example:80", "[::1", "[::1]:80x", "[]", "[]:80",
                             "[localhost]", "[1.2.3.4]", "localhost:evil.example", "localhost:80:80",
                             "localhost:80 ", "127.0.0.1:x", "::1", ":80"}) {
        EXPECT_EQ(host_part(host), "") << host;
        EXPECT_EQ(status(get({{"host", host}})), 400) << host;
        auto old = get({{"host", host}});
        old.http_1_0 = true;
        EXPECT_EQ(status(old), 400) << host;
    }
    EXPECT_EQ(host_part("[::1]"), "::1");
    EXPECT_EQ(host_part("[FE80::1]:8080"), "fe80::1");
    EXPECT_EQ(host_part("LAB.example:"), "lab.example");
}

// ---- proxies ----

TEST_F(GateTest, ProxyThatNobodyWasToldOf_IsRefusedAndSaysWhatToDo) {
    options_.loopback.role = Role::kAdmin;
    options_.loopback.name = "loopback";
    for (const char* header :
         {"x-forwarded-for", "x-forwarded-proto", "x-forwarded-host", "forwarded", "x-real-ip", "via"}) {
        auto request = get({{header, "192.0.2.1"}});
        request.peer.loopback = true;
        const auto refused = make().admit(request, at(0ms));
        ASSERT_FALSE(refused) << header;
        EXPECT_EQ(refused.error().status, 403);
        EXPECT_THAT(refused.error().text, testing::HasSubstr("start it with --trusted-proxy"));
        request.headers.emplace_back("authorization", "Bearer see");
        EXPECT_EQ(role(request), Role::kViewer) << "who has a token needs no right of this machine";
    }
    auto plain = get();
    plain.peer.loopback = true;
    EXPECT_EQ(role(plain), Role::kAdmin);
}

TEST_F(GateTest, BehindAProxy_ClientsAreWhomTheProxyNames) {
    options_.behind_proxy = true;
    const auto peer = [&](std::vector<std::pair<std::string, std::string>> headers,
                          const char* from = "127.0.0.1") {
        auto request = get(std::move(headers));
        request.peer = {from, std::string_view(from) == "127.0.0.1", false};
        return make().peer_of(request);
    };
    EXPECT_EQ(peer({{"x-forwarded-for", "192.0.2.7"}}).address, "192.0.2.7");
    EXPECT_EQ(peer({{"x-forwarded-for", "6.6.6.6, 192.0.2.7"}}).address, "192.0.2.7")
        << "what stands before it the client may have written";
    EXPECT_EQ(peer({{"x-forwarded-for", "6.6.6.6"}, {"x-forwarded-for", "192.0.2.7"}}).address, "192.0.2.7");
    EXPECT_EQ(peer({{"x-forwarded-for", "[2001:db8::7]:4711"}}).address, "2001:db8::7");
    EXPECT_EQ(peer({{"x-forwarded-for", "192.0.2.7:4711"}}).address, "192.0.2.7");
    EXPECT_EQ(peer({{"forwarded", "for=6.6.6.6, for=\"[2001:db8::7]:4711\";proto=https"}}).address,
              "2001:db8::7");
    EXPECT_EQ(peer({{"x-forwarded-for", "192.0.2.7"}, {"forwarded", "for=6.6.6.6"}}).address, "192.0.2.7");
    for (const char* nonsense : {"", ",", "unknown", "a b", "[", "[]", ":", "1.2.3", "\xff"})
        EXPECT_EQ(peer({{"x-forwarded-for", nonsense}}).address, "127.0.0.1") << nonsense;
    for (const char* nonsense : {"for", "for=", "for=\"", ";;;", "=;for=_hidden", "for=[;proto"})
        EXPECT_EQ(peer({{"forwarded", nonsense}}).address, "127.0.0.1") << nonsense;
    EXPECT_EQ(peer({{"x-forwarded-for", "192.0.2.7"}}, "10.0.0.9").address, "10.0.0.9")
        << "not from the proxy";
    EXPECT_EQ(peer({{"x-forwarded-for", "192.0.2.7"}}, "").address, "192.0.2.7") << "a Unix socket";
    EXPECT_FALSE(peer({}).secure);
    EXPECT_TRUE(peer({{"x-forwarded-proto", "https"}}).secure);
    EXPECT_FALSE(peer({{"x-forwarded-proto", "https, http"}}).secure);
    EXPECT_TRUE(peer({{"forwarded", "for=192.0.2.7;Proto=HTTPS"}}).secure);
    EXPECT_FALSE(peer({{"x-forwarded-proto", "https"}}, "10.0.0.9").secure);
    options_.behind_proxy = false;
    EXPECT_EQ(peer({{"x-forwarded-for", "192.0.2.7"}}).address, "127.0.0.1") << "no proxy, no such word";
}

TEST(Networks, OfIpv6TheFirst64Bits_OfIpv4TheAddress) {
    using http::network_of;
    EXPECT_EQ(network_of("2001:db8:1:2:3:4:5:6"), "2001:db8:1:2::/64");
    EXPECT_EQ(network_of("2001:db8:1:2::1"), network_of("2001:db8:1:2:ffff::"));
    EXPECT_NE(network_of("2001:db8:1:2::1"), network_of("2001:db8:1:3::1"));
    EXPECT_EQ(network_of("::ffff:192.0.2.7"), "192.0.2.7");
    EXPECT_EQ(network_of("fe80::1%eth0"), "fe80::/64");
    EXPECT_EQ(network_of("192.0.2.7"), "192.0.2.7");
    EXPECT_EQ(network_of(""), "");
    EXPECT_EQ(network_of("no address: at all"), "no address: at all");
}

// ---- limits of log-ins ----

TEST_F(GateTest, CodesOfOneName_LeaveThoseOfOthers) {
    Gate gate = make();
    Rights anonymous;
    anonymous.role = Role::kViewer;
    anonymous.name = "anonymous";
    const auto now = at(0ms).time;
    int made = 0;
    for (int i = 0; i < 2000; ++i)
        made += !gate.logins().make_code(anonymous, now).empty();
    EXPECT_EQ(made, static_cast<int>(Logins::kMaxCodes));
    EXPECT_NE(gate.logins().make_code(*gate.tokens().named("anna"), now), "") << "another name";
    EXPECT_NE(gate.logins().make_code(anonymous, at(30s).time), "") << "they last 30 s";
}

TEST_F(GateTest, LogInsOfOneName_EndItsOldestAndNobodyElses) {
    Gate gate = make();
    const auto log_in = [&](const char* name, std::chrono::milliseconds time) {
        const auto code = gate.logins().make_code(*gate.tokens().named(name), at(time).time);
        return *gate.logins().redeem(code, at(time).time);
    };
    const auto anna = log_in("anna", 0ms);
    const auto first = log_in("hall", 1ms);
    const auto second = log_in("hall", 2ms);
    for (std::size_t i = 2; i < Logins::kMaxSessions + 1; ++i)
        log_in("hall", std::chrono::milliseconds(i + 1));
    EXPECT_FALSE(gate.logins().session(first, at(1s).time)) << "its oldest";
    EXPECT_TRUE(gate.logins().session(second, at(1s).time));
    for (int i = 0; i < 2000; ++i)
        log_in("hall", 2s);
    EXPECT_TRUE(gate.logins().session(anna, at(3s).time));
    EXPECT_EQ(gate.logins().sessions(), Logins::kMaxSessions + 1);
}

}  // namespace
}  // namespace asip::gateway
