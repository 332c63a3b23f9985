// SPDX-License-Identifier: Apache-2.0
// Links of boards: docs/links.md.
#include "api_bench.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr const char* kShown =
    R"({"version":1,"board":"lamp","links":[{"name":"a","from":"desk/io/2","when":"toggles","to":"io/13",)"
    R"("user":"gate","last":"set to on"},{"name":"b","from":"hall/distance/0","when":"above","level":30,"to":"io/5",)"
    R"("user":"ann","fault":"hall is not heard"},{"name":"broken"},7],"set_aside":["b.json"]})";

class LinksApi : public ApiTest {
  protected:
    explicit LinksApi(Role role = Role::kOperator) : ApiTest(role) {
        for (const auto* board : {"desk", "lamp", "hall"})
            announce(board);
        bus("asip/lamp/$links", kShown);
    }
    std::vector<std::string> names(const std::string& board, const std::string& token = {}) {
        std::vector<std::pair<std::string, std::string>> headers;
        if (!token.empty()) headers.emplace_back("authorization", "Bearer " + token);
        std::vector<std::string> names;
        const auto body = ask("GET", "/api/boards/" + board + "/links", {}, headers)->body();
        for (const auto& each : body["items"])
            names.push_back(each["name"]);
        return names;
    }
    void limited_token() {
        gateway_->gate().set_tokens(
            *Tokens::parse("operator part " + hash_of("some") + " boards=desk,lamp\n"));
    }
};

TEST_F(LinksApi, LinksFromAndToABoard_AreShownInWords) {
    const auto lamp = get("/api/boards/lamp/links")->body();
    ASSERT_EQ(lamp["items"].size(), 2u);
    EXPECT_EQ(lamp["items"][0]["rule"], "each press of desk/io/2 switches io/13");
    EXPECT_EQ(lamp["items"][0]["state"], "on");
    EXPECT_EQ(lamp["items"][0]["yours"], true);
    EXPECT_EQ(lamp["items"][1]["state"], "hall is not heard");
    EXPECT_EQ(lamp["items"][1]["yours"], false) << "ann set it";
    EXPECT_EQ(lamp["set_aside"][0], "b.json");
    EXPECT_THAT(names("desk"), testing::ElementsAre("a"));
    EXPECT_THAT(names("hall"), testing::ElementsAre("b"));
    EXPECT_EQ(get("/api/boards/none/links")->status(), 404);
    bus("asip/lamp/$links", "");
    EXPECT_TRUE(names("lamp").empty());
}

TEST_F(LinksApi, WhatIsNoDocument_ShowsNothing_AndTheNextOneIsShown) {
    for (const auto& text : {std::string("nonsense"), std::string("[]"), std::string(R"({"links":7})"),
                             std::string(R"({"links":{"a":{"name":[]}}})"), std::string(300'000, ' ')}) {
        bus("asip/lamp/$links", text);
        EXPECT_EQ(get("/api/boards/lamp/links")->status(), 200);
        EXPECT_TRUE(names("lamp").empty()) << text.substr(0, 40);
    }
    bus("asip/unheard/$links", kShown);
    EXPECT_THAT(names("desk"), testing::IsEmpty()) << "no board is called so";
    bus("asip/lamp/$links", kShown);
    EXPECT_THAT(names("desk"), testing::ElementsAre("a"));
}

TEST_F(LinksApi, Changes_GoToTheTargetsAgent_WhichHasTheLastWord) {
    const auto sent =
        ask("POST", "/api/boards/lamp/links", R"({"set":{"name":"c","from":"desk/io/3","to":"io/13"}})");
    ASSERT_EQ(published_.size(), 1u);
    EXPECT_EQ(published_[0].topic, "asip/lamp/$link/gate/gw");
    EXPECT_EQ(json::parse(published_[0].payload)["set"]["from"], "desk/io/3");
    answer(R"({"status":"refused","reason":"invalid","error":"io/13 is no switch"})");
    EXPECT_EQ(sent->status(), 400);
    EXPECT_EQ(sent->detail(), "io/13 is no switch");
    const auto removed = ask("POST", "/api/boards/lamp/links", R"({"remove":"a"})");
    answer(R"({"status":"ok","proof":"kept","answer":"1"})");
    EXPECT_EQ(removed->status(), 200);
}

TEST_F(LinksApi, AnotherForm_IsRefusedBeforeItIsSent) {
    for (const char* body : {"", "{}", "[]", R"({"set":7})", R"({"remove":"*"})", R"({"remove":7})",
                             R"({"raw":"x"})", R"({"remove":"a","enable":"a"})"})
        EXPECT_THAT(ask("POST", "/api/boards/lamp/links", body)->detail(), HasSubstr("the body must be"))
            << body;
    bus("asip/servicebus/lamp/$state", "offline");
    EXPECT_EQ(ask("POST", "/api/boards/lamp/links", R"({"remove":"a"})")->status(), 503);
    EXPECT_TRUE(published_.empty());
}

TEST_F(LinksApi, LimitedToken_NeitherSeesNorMakesLinksOfOtherBoards) {
    limited_token();
    const std::vector<std::pair<std::string, std::string>> as{{"authorization", "Bearer some"}};
    EXPECT_THAT(names("lamp", "some"), testing::ElementsAre("a"));
    const auto secret =
        R"({"set":{"name":"c","from":"hall/distance/0","when":"above","level":1,"to":"io/13"}})";
    EXPECT_EQ(ask("POST", "/api/boards/lamp/links", secret, as)->status(), 403);
    EXPECT_EQ(ask("POST", "/api/boards/lamp/links", R"({"remove":"b"})", as)->status(), 404);
    EXPECT_TRUE(published_.empty());
    ask("POST", "/api/boards/lamp/links", R"({"remove":"a"})", as);
    EXPECT_EQ(published_.size(), 1u);
}

class ViewersLinks : public LinksApi {
  protected:
    ViewersLinks() : LinksApi(Role::kViewer) {}
};

TEST_F(ViewersLinks, AreReadAlone) {
    EXPECT_EQ(get("/api/boards/lamp/links")->body()["items"][0]["yours"], false);
    EXPECT_EQ(ask("POST", "/api/boards/lamp/links", R"({"remove":"a"})")->status(), 403);
    EXPECT_TRUE(published_.empty());
}

}  // namespace
}  // namespace asip::gateway
