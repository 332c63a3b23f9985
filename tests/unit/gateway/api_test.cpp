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

TEST_F(ApiTest, EachAnswerOfTheBus_HasItsStatus) {
    announce();
    const std::vector<std::pair<std::string, int>> answers{
        {R"({"status":"ok","proof":"fence"})", 200},
        {R"({"status":"error","code":7,"error":"INVALID_DEVICE_NUMBER"})", 422},
        {R"({"status":"refused","reason":"invalid","error":"x"})", 400},
        {R"({"status":"refused","reason":"queue-full","error":"x"})", 429},
        {R"({"status":"refused","reason":"board-not-there","error":"x"})", 503},
        {R"({"status":"refused","reason":"stopped","error":"x"})", 409},
        {R"({"status":"timeout","reason":"doubt"})", 504},
    };
    for (const auto& [payload, status] : answers) {
        const auto sent = ask("POST", "/api/boards/uno1/services/servo/commands/write", "[0,90]");
        ASSERT_EQ(sent->status(), 0);
        EXPECT_EQ(published_.back().payload, R"({"write":[0,90],"deadline_ms":5000})");
        answer(payload);
        EXPECT_EQ(sent->status(), status) << payload;
        EXPECT_EQ(sent->header("Retry-After"), status == 429 || status == 503 ? "1" : "");
        EXPECT_EQ(sent->response->content_type,
                  status == 200 ? "application/json" : "application/problem+json");
        if (status == 422) {
            EXPECT_EQ(sent->body()["code"], 7);
            EXPECT_EQ(sent->detail(), "INVALID_DEVICE_NUMBER");
        }
        EXPECT_EQ(sent->body().value("proof", ""), status == 200 ? "fence" : "");
    }
}

TEST_F(ApiTest, ArgumentsThatDoNotFit_AreRefusedBeforeTheyAreSent) {
    announce();
    const auto wrong = ask("POST", "/api/boards/uno1/services/servo/commands/write", "[0,999]");
    EXPECT_EQ(wrong->status(), 400);
    EXPECT_THAT(wrong->detail(), HasSubstr("999 is above 180"));
    EXPECT_EQ(ask("POST", "/api/boards/uno1/services/servo/commands/write", "[0,")->status(), 400);
    EXPECT_EQ(ask("POST", "/api/boards/uno1/services/servo/commands/write?deadline_ms=7", "[0,90]")->status(),
              400);
    EXPECT_TRUE(published_.empty());
    ask("POST", "/api/boards/uno1/services/servo/commands/write", R"({"servo":0,"angle":90})");
    EXPECT_EQ(published_.size(), 1u);
}

TEST_F(ApiTest, ServiceOfAnotherModel_CommandsAreCheckedByThatOne) {
    announce();
    const std::string write = "/api/boards/uno1/services/servo/commands/write";
    EXPECT_EQ(ask("POST", write, "[0,90]")->status(), 0) << "it is on its way";
    bus("asip/servicebus/uno1/$description",
        R"({"board":"uno1","session":"s1","seq":2,"lease":60,"services":[)"
        R"({"name":"servo","id":"S","model":"distance@1","title":"Servos"}]})");
    EXPECT_EQ(ask("POST", write, "[0,90]")->status(), 404);
    EXPECT_EQ(ask("POST", "/api/boards/uno1/services/servo/commands/measure")->status(), 0);
    EXPECT_EQ(get("/api/boards/uno1/services/servo")->body()["model"]["name"], "distance");
}

TEST_F(ApiTest, MoreBoardsThanModelsAreKeptOf_EachIsCheckedByItsOwn) {
    for (std::size_t i = 0; i < api::BoardModels::kMaxBoards + 2; ++i) {
        const auto board = "b" + std::to_string(i);
        announce(board);
        EXPECT_EQ(ask("POST", "/api/boards/" + board + "/services/servo/commands/write", "[0,181]")->status(),
                  400);
    }
    EXPECT_EQ(ask("POST", "/api/boards/b0/services/servo/commands/write", "[0,181]")->status(), 400);
}

TEST_F(ApiTest, IdempotencyKey_TwiceIsOneCommandAndAnotherCommandIsRefused) {
    announce();
    const std::string path = "/api/boards/uno1/services/servo/commands/write";
    const auto first = ask("POST", path, "[0,90]", {{"idempotency-key", "k1"}});
    answer(R"({"status":"ok","proof":"fence"})");
    EXPECT_EQ(ask("POST", path, "[0,90]", {{"idempotency-key", "k1"}})->status(), 200);
    EXPECT_EQ(published_.size(), 1u);
    EXPECT_EQ(ask("POST", path, "[0,91]", {{"idempotency-key", "k1"}})->status(), 409);
    EXPECT_EQ(ask("POST", path, "[0,91]", {{"idempotency-key", "k1"}, {"asip-session", "tab 2"}})->status(),
              0)
        << "another session's k1 is another command";
    EXPECT_EQ(ask("POST", path, "[0,91]", {{"idempotency-key", "a/b"}})->status(), 400);
    EXPECT_EQ(get("/api/commands/k1")->body()["answer"]["status"], "ok");
    EXPECT_EQ(get("/api/commands/k1")->body()["by"], "loopback");
    EXPECT_EQ(get("/api/commands/k2")->status(), 404);
}

TEST_F(ApiTest, LateAnswer_IsFoundAfterThe504) {
    announce();
    const auto sent = ask("POST", "/api/boards/uno1/services/servo/commands/write?deadline_ms=100", "[0,90]");
    pass(600ms);
    ASSERT_EQ(sent->status(), 504);
    const auto location = sent->header("Location");
    answer(R"({"status":"ok","proof":"fence"})");
    const auto found = get(location)->body();
    EXPECT_EQ(found["answer"]["status"], "ok");
    EXPECT_EQ(found["late"], true);
}

// Each operation of the document, with what nobody would call a board, service, command, model or id.
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

class ProxiedApi : public ApiTest {
  protected:
    ProxiedApi() : ApiTest(Role::kAdmin, "/asip") {}
};

TEST_F(ProxiedApi, LocationOfACommand_IsBelowTheBasePath) {
    announce();
    const auto sent = ask("POST", "/asip/api/boards/uno1/services/servo/commands/write", "[0,90]",
                          {{"idempotency-key", "7"}});
    answer(R"({"status":"ok","proof":"fence"})");
    ASSERT_EQ(sent->status(), 200);
    EXPECT_EQ(sent->header("Location"), "/asip/api/commands/7");
    EXPECT_EQ(get(sent->header("Location"))->body()["answer"]["proof"], "fence");
    const auto refused = ask("POST", "/asip/api/boards/uno1/services/servo/commands/write", "[0,90]",
                             {{"idempotency-key", "8"}});
    answer(R"({"status":"error","code":7,"error":"INVALID_DEVICE_NUMBER"})");
    EXPECT_EQ(refused->header("Location"), "/asip/api/commands/8");
}

TEST_F(ApiTest, BoardThatIsGone_Is503WithoutAsking) {
    announce();
    bus("asip/servicebus/uno1/$state", "lost");
    const auto sent = ask("POST", "/api/boards/uno1/services/servo/commands/write", "[0,90]");
    EXPECT_EQ(sent->status(), 503);
    EXPECT_EQ(sent->body()["reason"], "board-not-there");
    EXPECT_TRUE(published_.empty());
}

TEST_F(ApiTest, RawLines_GoTogether) {
    announce();
    ask("POST", "/api/boards/uno1/raw", R"({"lines":["I,P,13,3","I,d,13,1"]})");
    ASSERT_EQ(published_.size(), 1u);
    EXPECT_EQ(published_[0].topic, "asip/uno1/in");
    EXPECT_EQ(json::parse(published_[0].payload)["raw"], "I,P,13,3\nI,d,13,1");
    for (const char* body :
         {"", "[]", R"({"lines":[]})", R"({"lines":[1]})", R"({"lines":"x"})", R"({"lines":["x"],"y":1})"})
        EXPECT_EQ(ask("POST", "/api/boards/uno1/raw", body)->status(), 400) << body;
    EXPECT_EQ(published_.size(), 1u);
}

TEST_F(ApiTest, Forget_OnlyWhatIsNotAliveAndByTheRegistry) {
    announce();
    EXPECT_EQ(ask("DELETE", "/api/boards/uno1")->status(), 409);
    bus("asip/servicebus/uno1/$state", "offline");
    const auto forgotten = ask("DELETE", "/api/boards/uno1");
    ASSERT_EQ(published_.size(), 1u);
    EXPECT_EQ(json::parse(published_[0].payload)["forget"], "uno1");
    mqtt::Message reply;
    reply.topic = published_[0].response_topic;
    reply.correlation = published_[0].correlation;
    reply.payload = R"({"registry":"r","epoch":"e","seq":2,"forgotten":["uno1"],"items":[],"find":"boards"})";
    gateway_->message(reply);
    EXPECT_EQ(forgotten->status(), 200);
    EXPECT_EQ(forgotten->body()["forgotten"][0], "uno1");
    const auto nobody = ask("DELETE", "/api/boards/uno1");
    pass(3s);
    EXPECT_EQ(nobody->status(), 503) << "no registry answers";
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

// However many WebSockets somebody opens.
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
    EXPECT_EQ(published_.back().response_topic, "asip/reply/gate/uno1/gw/urgent/stop");
    answer(R"({"status":"ok","proof":"fence"})");
    EXPECT_EQ(stopped->status(), 200);
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

TEST_F(LimitedApi, CommandsEnvelope_NamesWhoSentIt) {
    announce("uno1");
    as_anna("POST", "/api/boards/uno1/services/servo/commands/write", "[0,90]");
    ASSERT_EQ(published_.size(), 1u);
    EXPECT_EQ(published_[0].user_properties[0].second, "anna");
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

}  // namespace
}  // namespace asip::gateway
