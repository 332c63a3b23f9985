// SPDX-License-Identifier: Apache-2.0
#include "api_bench.hpp"
#include "gateway/api/routes.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST_F(ApiTest, Boards_AreTheRegistrysAnswer) {
    announce("uno1");
    announce("uno2");
    const auto all = get("/api/boards?limit=1");
    ASSERT_EQ(all->status(), 200);
    EXPECT_EQ(all->body()["items"][0]["board"], "uno1");
    EXPECT_FALSE(all->body()["cursor"].get<std::string>().empty());
    EXPECT_EQ(get("/api/boards?kind=servo,tone&state=online&board=*2")->body()["items"].size(), 1u);
    EXPECT_EQ(get("/api/boards?state=lost")->body()["items"].size(), 0u);
    EXPECT_EQ(get("/api/services?service=dist*")->body()["items"].size(), 2u);
}

TEST_F(ApiTest, TwoSlashesOrOneAtTheEnd_AreTheSameAddress) {
    announce();
    for (const char* address :
         {"//api/boards", "/api//boards", "/api/boards/", "///api///boards///", "/api/boards/?limit=1"})
        EXPECT_EQ(get(address)->body()["items"].size(), 1u) << address;
    EXPECT_EQ(get("/api/boards/uno1/services//servo/")->body()["name"], "servo");
    EXPECT_EQ(get("/healthz/")->status(), 200);
    for (const std::string address : {"/readyz", "/metrics", "/api/status"})
        EXPECT_EQ(get("/" + address + "/")->status(), get(address)->status()) << address;
    EXPECT_EQ(get("/style.css/")->status(), 404) << "no folder of the page";
    ask("POST", "//api/boards/uno1/services/servo/commands/write/", "[0,90]");
    ASSERT_EQ(published_.size(), 1u);
    EXPECT_EQ(published_[0].topic, "asip/uno1/servo/in");
}

TEST_F(ApiTest, UnknownParameterOrValue_IsRefusedWithTheNearest) {
    EXPECT_EQ(get("/api/boards?stat=online")->detail(),
              "there is no parameter \"stat\" (did you mean \"state\"?)");
    EXPECT_EQ(get("/api/boards?limit=none")->status(), 400);
    EXPECT_EQ(get("/api/boards?limit=0")->status(), 400);
    EXPECT_EQ(get("/api/boards?full=perhaps")->status(), 400);
    EXPECT_EQ(get("/api/boards?board=a&board=b")->status(), 400);
    EXPECT_EQ(get("/api/boards?cursor=nonsense")->status(), 400);
}

TEST_F(ApiTest, PaperOnlyBoard_IsAResourceLikeAnyOther) {
    bus("asip/servicebus", "B4");
    bus("asip/servicebus/B4", "S1");
    bus("asip/servicebus/B4", "S2");
    bus("asip/B4/S1/out", "23.5");
    EXPECT_EQ(get("/api/boards/B4")->body()["services"].size(), 2u);
    EXPECT_EQ(get("/api/boards/B4/services/S2")->body()["name"], "S2");
    EXPECT_EQ(get("/api/boards/B4/services/S1/value")->body()["events"]["value"]["value"], 23.5);
    const auto sent = ask("POST", "/api/boards/B4/services/S1/commands/raw", "\"W,1\"");
    ASSERT_EQ(published_.size(), 1u);
    EXPECT_EQ(published_[0].topic, "asip/B4/S1/in");
    EXPECT_EQ(sent->status(), 0) << "waits for the answer";
    pass(6s);
    EXPECT_EQ(sent->status(), 504);
}

TEST_F(ApiTest, UnknownNames_Are404WithTheNearest) {
    announce();
    EXPECT_EQ(get("/api/boards/uno")->detail(), "no board \"uno\" is known (did you mean \"uno1\"?)");
    EXPECT_EQ(get("/api/boards/uno1/services/distanc")->detail(),
              "board uno1 has no service \"distanc\" (did you mean \"distance\"?)");
    EXPECT_EQ(ask("POST", "/api/boards/uno1/services/servo/commands/wirte")->detail(),
              "service servo has no command \"wirte\" (did you mean \"write\"?)");
    EXPECT_EQ(get("/api/models/srevo")->detail(), "no model \"srevo\" is known (did you mean \"servo\"?)");
    EXPECT_EQ(get("/api/boards/*")->status(), 404) << "a name, not a pattern";
    EXPECT_EQ(get("/api/nothing")->status(), 404);
    EXPECT_EQ(ask("PUT", "/api/boards/uno1", "", {{"content-type", "application/json"}})->status(), 405);
    EXPECT_EQ(ask("PUT", "/api/boards/uno1", "", {{"content-type", "application/json"}})->header("Allow"),
              "GET, HEAD, DELETE, OPTIONS");
}

TEST_F(ApiTest, ETag_UnchangedIs304AndAnyChangeIsNot) {
    announce();
    const auto first = get("/api/boards/uno1");
    const auto etag = first->header("ETag");
    ASSERT_FALSE(etag.empty());
    EXPECT_EQ(ask("GET", "/api/boards/uno1", "", {{"if-none-match", etag}})->status(), 304);
    EXPECT_EQ(ask("GET", "/api/boards", "", {{"if-none-match", etag}})->status(), 304);
    bus("asip/servicebus/uno1/$state", "offline");
    EXPECT_EQ(ask("GET", "/api/boards/uno1", "", {{"if-none-match", etag}})->status(), 200);
    EXPECT_TRUE(get("/api/boards?sort=last_seen")->header("ETag").empty())
        << "this order changes with each message";
}

TEST_F(ApiTest, Service_CarriesItsModel) {
    announce();
    const auto service = get("/api/boards/uno1/services/servo")->body();
    EXPECT_EQ(service["model"]["name"], "servo");
    EXPECT_TRUE(service["model"].contains("commands"));
    EXPECT_FALSE(get("/api/boards/uno1/services/X")->body().contains("model"));
    EXPECT_EQ(get("/api/models/servo")->body(), service["model"]);
}

// Each operation of the document, with what no user would call a board, service, command, model or id.
TEST_F(ApiTest, HostileNamesInEveryPath_AreRefusedAndNothingIsSent) {
    announce();
    const std::vector<std::string> hostile{"+",
                                           "#",
                                           "*",
                                           "?",
                                           "$SYS",
                                           "$stop",
                                           "servicebus",
                                           "registry",
                                           "..",
                                           "a/b",
                                           "uno1/servo",
                                           std::string("uno1\0", 5),
                                           "\r\nSet-Cookie: a=b",
                                           "\xff\xfe",
                                           "<script>alert(1)</script>",
                                           "' or 1=1 --",
                                           "{board}",
                                           "uno*",
                                           "%00",
                                           std::string(5000, 'a'),
                                           "\xc3\xa9",
                                           " "};
    int asked = 0;
    for (const auto& route : api::routes()) {
        for (const auto& name : hostile) {
            http::Request request;
            request.method = route.method;
            request.peer = {"127.0.0.1", true, false};
            request.headers = {{"host", "localhost"}, {"content-type", "application/json"}};
            request.body = "{}";
            bool any = false;
            for (std::string_view rest = route.path.substr(1); !rest.empty();) {
                const auto part = rest.substr(0, rest.find('/'));
                rest.remove_prefix(std::min(rest.size(), part.size() + 1));
                const bool taken = part.starts_with('{');
                any |= taken;
                request.segments.push_back(taken ? name : std::string(part));
            }
            if (!any) continue;
            ++asked;
            auto captured = std::make_shared<Captured>();
            gateway_->request(request, http::Reply(captured, 1));
            ASSERT_GE(captured->status(), 400) << route.id << " " << name;
            ASSERT_LT(captured->status(), 500) << route.id << " " << name;
            ASSERT_FALSE(captured->detail().empty()) << route.id << " " << name;
            ASSERT_LT(captured->response->body.size(), 2000u) << route.id;
            for (const auto& [key, value] : captured->response->headers)
                ASSERT_EQ(value.find_first_of("\r\n"), std::string::npos) << route.id << " " << key;
            ASSERT_TRUE(published_.empty()) << route.id << " " << name;
        }
    }
    EXPECT_GT(asked, 200);
    EXPECT_EQ(get("/api/boards/uno1")->status(), 200);
}

TEST_F(ApiTest, Labels_ChooseBoardsAndAreShown) {
    announce("uno1");
    bus("asip/servicebus/uno2/$description",
        R"({"board":"uno2","session":"s1","seq":1,"lease":60,"services":[{"name":"servo","id":"S","model":"servo@1"}],)"
        R"("labels":{"room":"lab"},"names":{"services":{"servo":"left arm"},"pins":{"13":"lamp"}}})");
    const auto chosen = get("/api/boards?labels=room%3Dlab")->body();
    ASSERT_EQ(chosen["items"].size(), 1u);
    EXPECT_EQ(chosen["items"][0]["labels"], json::parse(R"({"room":"lab"})"));
    EXPECT_EQ(get("/api/boards?labels=!room")->body()["items"][0]["board"], "uno1");
    EXPECT_EQ(get("/api/services?labels=room")->body()["items"][0]["label"], "left arm");
    const auto board = get("/api/boards/uno2")->body();
    EXPECT_EQ(board["names"]["pins"]["13"], "lamp");
    EXPECT_EQ(board["description"]["labels"]["room"], "lab");
    const auto wrong = get("/api/boards?labels=a%20b%3Dc");
    EXPECT_EQ(wrong->status(), 400);
    EXPECT_THAT(wrong->detail(), HasSubstr("is not a key"));
}

TEST_F(ApiTest, Value_LastOfEachEventAndTheNextWithWait) {
    announce();
    bus("asip/uno1/distance/out", R"({"distance":[42]})");
    const auto value = get("/api/boards/uno1/services/distance/value")->body();
    EXPECT_EQ(value["events"]["distance"]["value"], json::array({42}));
    const auto place = value["place"].get<std::string>();
    const auto next = get("/api/boards/uno1/services/distance/value?wait=10");
    EXPECT_EQ(next->status(), 0);
    bus("asip/uno1/distance/out", R"({"distance":[43]})");
    ASSERT_EQ(next->status(), 200);
    EXPECT_EQ(next->body()["events"]["distance"]["value"], json::array({43}));
    EXPECT_EQ(get("/api/boards/uno1/services/distance/value?wait=10&after=" + place)->status(), 200)
        << "what came in between is not lost";
    const auto none = get("/api/boards/uno1/services/distance/value?wait=1");
    pass(1s);
    EXPECT_EQ(none->status(), 200) << "then as it is";
    EXPECT_EQ(get("/api/boards/uno1/services/distance/value?wait=90")->status(), 400);
    EXPECT_EQ(get("/api/boards/uno1/services/distance/value?after=7")->status(), 400);
}

TEST_F(ApiTest, Values_SinceAPlaceOrATime) {
    announce();
    for (int i = 1; i <= 5; ++i) {
        time_ = std::chrono::seconds(i);
        bus("asip/uno1/distance/out", R"({"distance":[)" + std::to_string(i) + "]}");
    }
    const auto all = get("/api/boards/uno1/services/distance/values")->body();
    ASSERT_EQ(all["items"].size(), 5u);
    const auto third = all["items"][2]["place"].get<std::string>();
    const auto later = get("/api/boards/uno1/services/distance/values?since=" + third)->body();
    EXPECT_EQ(later["items"].size(), 2u);
    EXPECT_EQ(later["complete"], true);
    const auto by_time =
        get("/api/boards/uno1/services/distance/values?since=2023-11-14T22:13:24.000Z")->body();
    EXPECT_EQ(by_time["items"].size(), 1u);
    EXPECT_EQ(get("/api/boards/uno1/services/distance/values?since=other-3")->body()["complete"], false);
    EXPECT_EQ(get("/api/boards/uno1/services/distance/values?since=yesterday")->status(), 400);
}

TEST_F(ApiTest, BrokerAway_WhatIsKnownIsShownAndNothingIsSent) {
    announce();
    gateway_->disconnected();
    EXPECT_EQ(get("/api/boards/uno1")->status(), 200);
    EXPECT_EQ(get("/readyz")->status(), 503);
    EXPECT_EQ(get("/healthz")->status(), 200);
    EXPECT_EQ(ask("POST", "/api/boards/uno1/services/servo/commands/write", "[0,90]")->status(), 503);
    EXPECT_EQ(get("/api/events")->status(), 503) << "not confirmed before the bus is heard";
}

TEST_F(ApiTest, EventStream_BeginsWithTheSnapshotAndResumes) {
    announce();
    const auto stream = get("/api/events");
    ASSERT_TRUE(stream->source);
    EXPECT_EQ(stream->response->content_type, "text/event-stream");
    std::string text;
    stream->source->take(text, 100'000);
    EXPECT_THAT(text, HasSubstr("event: board\ndata: {\"board\":{"));
    EXPECT_THAT(text, HasSubstr("event: snapshot-end\ndata: {}"));
    bus("asip/servicebus/uno1/$state", "offline");
    text.clear();
    stream->source->take(text, 100'000);
    EXPECT_THAT(text, HasSubstr("event: state\n"));
    const auto id = text.substr(text.find("id: ") + 4, text.find('\n') - 4);
    bus("asip/servicebus/uno1/$state", "online");
    const auto again = ask("GET", "/api/events?last_event_id=" + id);
    text.clear();
    again->source->take(text, 100'000);
    EXPECT_THAT(text, testing::Not(HasSubstr("snapshot-end")));
    EXPECT_THAT(text, HasSubstr("\"was\":\"offline\""));
    EXPECT_EQ(ask("GET", "/api/events?last_event_id=nonsense")->status(), 400);
}

TEST_F(ApiTest, IdleStream_SendsACommentEvery15Seconds) {
    announce();
    for (const char* target : {"/api/events", "/api/boards/uno1/services/distance/stream"}) {
        const auto stream = get(target);
        ASSERT_TRUE(stream->source) << target;
        int woken = 0;
        stream->source->wake = [&] { ++woken; };
        const auto taken = [&] {
            std::string text;
            stream->source->take(text, 100'000);
            return text;
        };
        EXPECT_THAT(taken(), HasSubstr("event: snapshot-end")) << target;
        for (int comments = 1; comments <= 2; ++comments) {
            pass(14'900ms);
            EXPECT_EQ(woken, comments - 1) << target;
            EXPECT_EQ(taken(), "") << target;
            pass(100ms);
            EXPECT_EQ(woken, comments) << target << ": whoever writes it must be called";
            EXPECT_EQ(taken(), ":\n\n") << target;
            EXPECT_EQ(taken(), "") << target << ": one is enough";
        }
    }
}

TEST_F(ApiTest, StreamWithAValue_TheCommentIsDue15SecondsBehindIt) {
    announce();
    const auto stream = get("/api/boards/uno1/services/distance/stream");
    ASSERT_TRUE(stream->source);
    std::string text;
    stream->source->take(text, 100'000);
    pass(10'000ms);
    bus("asip/uno1/distance/out", R"({"distance":42})");
    text.clear();
    stream->source->take(text, 100'000);
    EXPECT_THAT(text, HasSubstr("event: value"));
    text.clear();
    pass(14'900ms);
    stream->source->take(text, 100'000);
    EXPECT_EQ(text, "");
    pass(100ms);
    stream->source->take(text, 100'000);
    EXPECT_EQ(text, ":\n\n");
}

TEST_F(ApiTest, ModelsAndPage_AreThere) {
    EXPECT_GT(get("/api/models")->body()["items"].size(), 5u);
    const auto page = get("/");
    EXPECT_EQ(page->status(), 200);
    EXPECT_THAT(page->header("Content-Security-Policy"), HasSubstr("default-src 'none'; script-src 'self'"));
    EXPECT_THAT(page->header("Content-Security-Policy"), HasSubstr("frame-ancestors 'none'"));
    EXPECT_EQ(page->header("X-Content-Type-Options"), "nosniff");
    EXPECT_EQ(get("/etc/passwd")->status(), 404);
    EXPECT_EQ(ask("GET", "/", "", {{"if-none-match", page->header("ETag")}})->status(), 304);
}

}  // namespace
}  // namespace asip::gateway
