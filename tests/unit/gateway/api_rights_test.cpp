// SPDX-License-Identifier: Apache-2.0
#include "api_bench.hpp"
#include "gateway/api/routes.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class ViewersApi : public ApiTest {
  protected:
    ViewersApi() : ApiTest(Role::kViewer) {}
};

TEST_F(ViewersApi, ReadsAndNothingElse) {
    announce();
    EXPECT_EQ(get("/api/boards/uno1")->status(), 200);
    EXPECT_EQ(ask("POST", "/api/boards/uno1/services/servo/commands/write", "[0,90]")->status(), 403);
    EXPECT_EQ(ask("POST", "/api/boards/uno1/raw", R"({"lines":["x"]})")->status(), 403);
    EXPECT_EQ(ask("DELETE", "/api/boards/uno1")->status(), 403);
    EXPECT_EQ(ask("POST", "/api/boards/uno1/labels", R"({"labels":{"a":"b"}})")->status(), 403);
    EXPECT_EQ(get("/api/status")->body()["you"]["label"], false);
    EXPECT_TRUE(published_.empty());
}

class OperatorsApi : public ApiTest {
  protected:
    OperatorsApi() : ApiTest(Role::kOperator) {}
};

TEST_F(OperatorsApi, CommandsButNoRawLinesAndNoForgetting) {
    announce();
    ask("POST", "/api/boards/uno1/services/servo/commands/write", "[0,90]");
    EXPECT_EQ(published_.size(), 1u);
    EXPECT_EQ(ask("POST", "/api/boards/uno1/raw", R"({"lines":["x"]})")->status(), 403);
    EXPECT_EQ(ask("DELETE", "/api/boards/uno1")->status(), 403);
}

TEST_F(OperatorsApi, FloodOfCommands_Is429) {
    announce();
    int refused = 0;
    for (int i = 0; i < 150; ++i)
        refused += ask("POST", "/api/boards/uno1/services/servo/commands/write", "[0,90]")->status() == 429;
    EXPECT_EQ(refused, 50) << "50 a second, twice as many at once";
    time_ += 1s;
    EXPECT_EQ(ask("POST", "/api/boards/uno1/services/servo/commands/write", "[0,90]")->status(), 0);
}

// However many WebSockets a client opens.
TEST_F(OperatorsApi, FloodOverTwoWebSockets_IsLimitedAsOne) {
    announce();
    Principal principal;
    principal.rights = *parse_role("operator");
    int refused = 0;
    for (int i = 0; i < 150; ++i) {
        const nlohmann::json command{
            {"command", "uno1/servo"}, {"write", {0, 90}}, {"id", std::to_string(i)}};
        api::websocket_command(
            *gateway_, principal, "address 127.0.0.1", i % 2 == 0 ? "one" : "two", command,
            [&](const std::string& answer) { refused += answer.find("too-many") != std::string::npos; });
    }
    EXPECT_EQ(refused, 50);
}

TEST_F(OperatorsApi, Stop_ItsAnswerComesPastThoseOfOthersWhereThereIsAConnectionForIt) {
    announce();
    ask("POST", "/api/stop");
    ASSERT_EQ(published_.size(), 1u);
    EXPECT_EQ(published_.back().response_topic, "asip/reply/gate/uno1/gw/stop");
    urgent_ready_ = true;
    const auto stopped = ask("POST", "/api/boards/uno1/stop");
    ASSERT_EQ(published_.size(), 2u);
    EXPECT_EQ(published_.back().response_topic, "asip/reply/gate/uno1/gw-urgent/stop");
    answer(R"({"status":"ok","proof":"fence"})");
    EXPECT_EQ(stopped->status(), 200);
}

TEST_F(OperatorsApi, StopsOfThoseWhoMay_AreUrgent_AndRequestsAreCountedToTheirTokens) {
    gateway_->gate().set_tokens(*Tokens::parse("operator anna " + hash_of("do") + "\nviewer hall " +
                                               hash_of("see") + "\noperator part " + hash_of("some") +
                                               " services=servo\n"));
    const auto asker = [this](const std::string& method, const std::string& target,
                              const std::string& token) {
        http::Request request;
        request.method = method;
        request.target = target;
        EXPECT_TRUE(http::split_target(request));
        request.headers = {{"host", "localhost"},
                           {"content-type", "application/json"},
                           {"authorization", "Bearer " + token}};
        request.peer = {"2001:db8:1:2:3::4", false, false};
        return gateway_->asker_of(request);
    };
    EXPECT_TRUE(asker("POST", "/api/stop", "do").urgent);
    EXPECT_TRUE(asker("POST", "/api/boards/uno1/stop?once=true", "do").urgent);
    EXPECT_FALSE(asker("POST", "/api/boards/uno1/raw", "do").urgent);
    EXPECT_FALSE(asker("GET", "/api/stop", "do").urgent);
    EXPECT_FALSE(asker("POST", "/api/stop", "see").urgent);
    EXPECT_FALSE(asker("POST", "/api/stop", "some").urgent);
    EXPECT_EQ(asker("GET", "/metrics", "see").name, "hall");
    EXPECT_EQ(asker("GET", "/metrics", "guessed").name, "address 2001:db8:1:2::/64");
}

class NobodysApi : public ApiTest {
  protected:
    NobodysApi() : ApiTest(Role::kNone) {}
};

TEST_F(NobodysApi, OnlyHealthAndThePage) {
    announce();
    EXPECT_EQ(get("/api/boards")->status(), 401);
    EXPECT_THAT(get("/api/boards")->header("WWW-Authenticate"), HasSubstr("Bearer"));
    EXPECT_EQ(get("/api/events")->status(), 401);
    EXPECT_EQ(get("/healthz")->status(), 200);
    EXPECT_EQ(get("/")->status(), 200);
}

class ApiBehindProxy : public ApiTest {
  protected:
    ApiBehindProxy() : ApiTest(Role::kNone, "/asip") {
        gateway_->gate().set_tokens(*Tokens::parse("operator anna " + hash_of("do") + "\n"));
    }
};

TEST_F(ApiBehindProxy, CookieIsSecureWhereTheProxySaysHttps) {
    const auto log_in = [&](const char* scheme) {
        const auto code = ask("POST", "/asip/api/codes", "{}", {{"authorization", "Bearer do"}});
        return ask("GET", "/asip/?code=" + code->body()["code"].get<std::string>(), "",
                   {{"x-forwarded-proto", scheme}})
            ->header("Set-Cookie");
    };
    EXPECT_THAT(log_in("https"), testing::EndsWith("; Secure"));
    EXPECT_THAT(log_in("http"), testing::Not(HasSubstr("Secure")));
}

TEST_F(ApiBehindProxy, EachClientHasLimitsOfItsOwn) {
    Gateway& gateway = *gateway_;
    gateway.gate().set_tokens(*Tokens::parse(""));
    const auto client = [&](const char* address) {
        http::Request request;
        request.headers = {{"x-forwarded-for", address}};
        request.peer = {"127.0.0.1", true, false};
        return client_of(Principal{}, gateway.gate().peer_of(request));
    };
    EXPECT_EQ(client("192.0.2.7"), "address 192.0.2.7");
    EXPECT_EQ(client("2001:db8:1:2::9"), "address 2001:db8:1:2::/64");
}

class LimitedApi : public ApiTest {
  protected:
    LimitedApi() : ApiTest(Role::kNone) {
        gateway_->gate().set_tokens(
            *Tokens::parse("operator anna " + hash_of("do") + " boards=uno1 services=servo\n"));
    }
    std::shared_ptr<Captured> as_anna(const std::string& method, const std::string& target,
                                      const std::string& body = {}) {
        return ask(method, target, body, {{"authorization", "Bearer do"}});
    }
};

TEST_F(LimitedApi, WhatTheTokenDoesNotShow_IsAsIfItWereNotThere) {
    announce("uno1");
    announce("uno2");
    EXPECT_EQ(as_anna("GET", "/api/boards")->body()["items"].size(), 1u);
    EXPECT_EQ(as_anna("GET", "/api/boards/uno2")->status(), 404);
    EXPECT_THAT(as_anna("GET", "/api/boards/uno2")->detail(), HasSubstr("uno1"))
        << "only what is seen is near";
    EXPECT_THAT(as_anna("GET", "/api/boards/uno3")->detail(), testing::Not(HasSubstr("uno2")));
    EXPECT_EQ(as_anna("GET", "/api/boards/uno1/services/distance")->status(), 404);
    EXPECT_EQ(as_anna("GET", "/api/boards/uno1/services/servo")->status(), 200);
    EXPECT_EQ(as_anna("GET", "/api/services")->body()["items"].size(), 1u);
    for (const std::string target :
         {"/api/boards/uno1", "/api/boards", "/api/boards?full=true", "/api/events"}) {
        const auto shown = as_anna("GET", target);
        std::string body(shown->response->text());
        if (shown->source) shown->source->take(body, 100'000);
        EXPECT_THAT(body, HasSubstr("servo")) << target;
        EXPECT_THAT(body, testing::Not(HasSubstr("distance"))) << target;
    }
    EXPECT_EQ(as_anna("POST", "/api/boards/uno2/services/servo/commands/write", "[0,90]")->status(), 404);
    const auto stream = as_anna("GET", "/api/events");
    std::string text;
    stream->source->take(text, 100'000);
    EXPECT_THAT(text, testing::Not(HasSubstr("uno2")));
}

// Raw lines reach every service.
TEST_F(LimitedApi, HistoryOfCommands_IsOfTheServicesThatItShows) {
    announce("uno1");
    const auto history = as_anna("GET", "/api/boards/uno1/history");
    answer(
        R"({"find":"history","items":[{"board":"uno1","what":"command","by":"bert","service":"servo","status":"ok"},)"
        R"({"board":"uno1","what":"command","by":"bert","service":"distance","status":"ok"},)"
        R"({"board":"uno1","what":"stop","by":"bert","status":"ok"},)"
        R"({"board":"uno2","what":"command","by":"bert","service":"servo","status":"ok"},)"
        R"({"board":"uno1","what":"state","state":"lost"}]})");
    ASSERT_EQ(history->status(), 200);
    const auto items = history->body()["items"];
    ASSERT_EQ(items.size(), 2u) << items;
    EXPECT_EQ(items[0]["by"], "bert");
    EXPECT_EQ(items[0]["service"], "servo");
    EXPECT_EQ(items[1]["what"], "state");
}

TEST_F(LimitedApi, RawRightOfATokenLimitedToServices_IsNone) {
    gateway_->gate().set_tokens(
        *Tokens::parse("operator+raw anna " + hash_of("do") + " boards=uno1 services=servo\n"));
    announce("uno1");
    EXPECT_EQ(as_anna("POST", "/api/boards/uno1/raw", R"({"lines":["D,M"]})")->status(), 403);
    gateway_->gate().set_tokens(*Tokens::parse("operator+raw anna " + hash_of("do") + " boards=uno1\n"));
    EXPECT_EQ(as_anna("POST", "/api/boards/uno1/raw", R"({"lines":["D,M"]})")->status(), 0) << "sent";
}

TEST_F(LimitedApi, TokenLimitedToServices_MayNotLabel_OneLimitedToBoardsMay) {
    announce("uno1");
    const auto refused = as_anna("POST", "/api/boards/uno1/labels", R"({"labels":{"a":"b"}})");
    EXPECT_EQ(refused->status(), 403);
    EXPECT_THAT(refused->detail(), testing::HasSubstr("limited to some services"));
    gateway_->gate().set_tokens(*Tokens::parse("operator anna " + hash_of("do") + " boards=uno1\n"));
    EXPECT_EQ(as_anna("POST", "/api/boards/uno1/labels", R"({"labels":{"a":"b"}})")->status(), 0) << "sent";
}

// A stop reaches every service of a board, also those that the token does not show.
TEST_F(LimitedApi, TokenLimitedToServices_StopsAndResumesNoWholeBoard) {
    announce("uno1");
    for (const char* path :
         {"/api/stop", "/api/resume", "/api/boards/uno1/stop", "/api/boards/uno1/resume"}) {
        const auto refused = as_anna("POST", path, "{}");
        EXPECT_EQ(refused->status(), 403) << path;
        EXPECT_THAT(refused->detail(), HasSubstr("limited to some services")) << path;
    }
    EXPECT_TRUE(published_.empty());
    EXPECT_EQ(as_anna("GET", "/api/status")->body()["you"]["stop"], false);
    EXPECT_EQ(as_anna("GET", "/api/status")->body()["you"]["command"], true);
    gateway_->gate().set_tokens(*Tokens::parse("operator anna " + hash_of("do") + " boards=uno1\n"));
    EXPECT_EQ(as_anna("GET", "/api/status")->body()["you"]["stop"], true);
    as_anna("POST", "/api/boards/uno1/stop", "{}");
    EXPECT_EQ(published_.size(), 1u) << "of whole boards";
    announce("uno2");
    const auto two = as_anna("POST", "/api/stop", R"({"boards":["uno1","uno2"]})");
    EXPECT_EQ(published_.size(), 2u) << "of uno1 alone: uno2 is as if it were not there";
    gateway_->gate().set_tokens(*Tokens::parse("admin anna " + hash_of("do") + " services=servo\n"));
    EXPECT_EQ(as_anna("DELETE", "/api/boards/uno1")->status(), 403) << "a board is forgotten as a whole";
}

TEST_F(LimitedApi, CommandsEnvelope_NamesWhoSentIt) {
    announce("uno1");
    as_anna("POST", "/api/boards/uno1/services/servo/commands/write", "[0,90]");
    ASSERT_EQ(published_.size(), 1u);
    EXPECT_EQ(json::parse(published_[0].payload).at("by"), "anna");
}

TEST_F(LimitedApi, CodeOfAToken_BecomesACookieWithItsRights) {
    announce("uno1");
    const auto code = as_anna("POST", "/api/codes", "{}");
    ASSERT_EQ(code->status(), 200);
    const auto opened = get("/?code=" + code->body()["code"].get<std::string>());
    EXPECT_EQ(opened->status(), 303);
    EXPECT_EQ(opened->header("Location"), "/");
    const auto cookie = opened->header("Set-Cookie");
    EXPECT_THAT(cookie, HasSubstr("HttpOnly; SameSite=Strict"));
    const auto value = cookie.substr(0, cookie.find(';'));
    EXPECT_EQ(ask("GET", "/api/status", "", {{"cookie", value}})->body()["you"]["name"], "anna");
    EXPECT_EQ(get("/?code=wrong")->status(), 401);
    EXPECT_EQ(ask("DELETE", "/api/session", "", {{"cookie", value}})->status(), 204);
    EXPECT_EQ(ask("GET", "/api/status", "", {{"cookie", value}})->status(), 401);
}

using Headers = std::vector<std::pair<std::string, std::string>>;

class LogIns : public ApiTest {
  protected:
    LogIns() : ApiTest(Role::kNone) {
        gateway_->gate().set_tokens(*Tokens::parse("operator anna " + hash_of("do") + "\nviewer mallory " +
                                                   hash_of("see") + "\nkiosk hall " + hash_of("look") +
                                                   " boards=uno1\n"));
    }
    std::string code(const char* token) {
        const auto made =
            ask("POST", "/api/codes", "{}", {{"authorization", std::string("Bearer ") + token}});
        return made->body().value("code", "");
    }
    static std::string cookie_in(const Captured& answer) {
        const auto set = answer.header("Set-Cookie");
        return set.substr(0, set.find(';'));
    }
    std::string name(const std::string& cookies) {
        const auto status = ask("GET", "/api/status", "", {{"cookie", cookies}});
        return status->status() == 200 ? status->body()["you"]["name"].get<std::string>() : std::string();
    }
    /// What a browser gets that follows an address with a code.
    std::shared_ptr<Captured> follow(const std::string& address, const Headers& headers) {
        return ask("GET", address, "", headers);
    }
};

TEST_F(LogIns, Session_MakesNoCodes_SoThatItEnds) {
    const auto cookie = cookie_in(*get("/?code=" + code("do")));
    ASSERT_EQ(name(cookie), "anna");
    const auto refused = ask("POST", "/api/codes", "{}", {{"cookie", cookie}});
    EXPECT_EQ(refused->status(), 403);
    EXPECT_THAT(refused->detail(), HasSubstr("asipctl open"));
    EXPECT_EQ(ask("POST", "/api/codes", "{}", {{"cookie", cookie}, {"authorization", "Bearer do"}})->status(),
              200)
        << "with the token itself";
    time_ += 12h;
    EXPECT_EQ(name(cookie), "");
}

TEST_F(LogIns, Kiosk_MakesNoCodes) {
    EXPECT_EQ(ask("POST", "/api/codes", "{}", {{"authorization", "Bearer look"}})->status(), 403);
}

TEST_F(LogIns, LinkOfAnotherSite_LogsNobodyIn) {
    for (const char* site : {"cross-site", "same-site"}) {
        const auto address = "/?code=" + code("see");
        const auto refused = follow(address, {{"sec-fetch-site", site}, {"accept", "text/html"}});
        EXPECT_EQ(refused->status(), 403) << site;
        EXPECT_EQ(refused->header("Set-Cookie"), "");
        const auto typed = follow(address, {{"sec-fetch-site", "none"}, {"accept", "text/html"}});
        EXPECT_EQ(typed->status(), 303) << "the code is not used up";
    }
}

TEST_F(LogIns, WhereAnotherSessionIsValid_TheUserIsAsked) {
    const auto annas = cookie_in(*get("/?code=" + code("do")));
    const Headers typed{{"cookie", annas}, {"sec-fetch-site", "none"}, {"accept", "text/html"}};
    const Headers own{{"cookie", annas}, {"sec-fetch-site", "same-origin"}, {"accept", "text/html"}};
    const auto address = "/?code=" + code("see");
    for (const auto& asked :
         {follow(address, typed), follow(address + "&replace=true", typed), follow(address, own)}) {
        EXPECT_EQ(asked->status(), 409);
        EXPECT_EQ(asked->header("Set-Cookie"), "");
        EXPECT_THAT(std::string(asked->response->text()),
                    testing::AllOf(HasSubstr("anna"), HasSubstr("mallory"), HasSubstr("replace=true")));
    }
    const auto agreed = follow(address + "&replace=true", own);
    EXPECT_EQ(agreed->status(), 303);
    EXPECT_EQ(name(cookie_in(*agreed)), "mallory");
    EXPECT_EQ(follow("/?code=" + code("do"), typed)->status(), 303) << "the same name needs no question";
    gateway_->gate().set_tokens(*Tokens::parse("viewer mallory " + hash_of("see")));
    EXPECT_EQ(follow("/?code=" + code("see"), typed)->status(), 303) << "nor does a session that is over";
}

// Without TLS browsers do not say which site leads here. A SameSite=Strict cookie does.
TEST_F(LogIns, WithoutSecFetchSite_OnlyOurOwnPageLogsIn) {
    const auto annas = cookie_in(*get("/?code=" + code("do")));
    const auto address = "/?code=" + code("see");
    const Headers html{{"accept", "text/html,*/*;q=0.8"}};
    const auto first = follow(address, html);
    ASSERT_EQ(first->status(), 200);
    EXPECT_THAT(std::string(first->response->text()), HasSubstr("again=true"));
    const auto mark = cookie_in(*first);
    EXPECT_THAT(first->header("Set-Cookie"), HasSubstr("HttpOnly; SameSite=Strict"));
    EXPECT_EQ(name(mark), "") << "nobody is logged in yet";
    EXPECT_EQ(follow(address + "&again=true", html)->status(), 403) << "a link of another site sends no mark";
    const Headers with_session{html[0], {"cookie", mark + "; " + annas}};
    EXPECT_EQ(follow(address + "&again=true", with_session)->status(), 409) << "now the session is seen";
    EXPECT_EQ(name(annas), "anna");
    const auto agreed = follow(address + "&replace=true", with_session);
    EXPECT_EQ(agreed->status(), 303);
    EXPECT_EQ(name(cookie_in(*agreed)), "mallory");
    const auto other = "/?code=" + code("see");
    EXPECT_EQ(follow(other + "&again=true", with_session)->status(), 403) << "a mark is of one code";
}

/// Between the address and the page.
TEST_F(LogIns, ScriptOfTheQuestion_IsServed) {
    EXPECT_EQ(get("/login.js")->status(), 200);
}

}  // namespace
}  // namespace asip::gateway
