// SPDX-License-Identifier: Apache-2.0
#include "api_bench.hpp"
#include "gateway/api/board_models.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;
using testing::HasSubstr;

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
        const auto command = nlohmann::json::parse(published_.back().payload);
        EXPECT_EQ(command["write"], nlohmann::json({0, 90}));
        EXPECT_EQ(command["deadline_ms"], 5000);
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
    const auto part =
        ask("POST", "/api/boards/uno1/services/servo/commands/write?deadline_ms=99.5", "[0,90]");
    EXPECT_EQ(part->detail(), "deadline_ms: must be a whole number from 50 to 60000");
    EXPECT_EQ(get("/api/boards?limit=1.5")->status(), 400);
    EXPECT_TRUE(published_.empty());
    ask("POST", "/api/boards/uno1/services/servo/commands/write", R"({"servo":0,"angle":90})");
    EXPECT_EQ(published_.size(), 1u);
}

TEST_F(ApiTest, Load_GoesToTheBoardsAgent) {
    announce();
    const auto sent = ask("POST", "/api/boards/uno1/load?deadline_ms=60000", R"({"board":"mega"})");
    ASSERT_FALSE(published_.empty());
    EXPECT_EQ(published_.back().topic, "asip/uno1/in");
    const auto payload = json::parse(published_.back().payload);
    EXPECT_EQ(payload["port"], "load");
    EXPECT_EQ(payload["firmware"], "AsipServices");
    EXPECT_EQ(payload["board"], "mega");
    answer(R"({"status":"ok","proof":"answer","answer":{"after":{"sketch":"AsipServices"}}})");
    EXPECT_EQ(sent->status(), 200);
    EXPECT_EQ(sent->body()["answer"]["after"]["sketch"], "AsipServices");
    const auto refused = ask("POST", "/api/boards/uno1/load", "{}");
    answer(R"({"status":"refused","reason":"not-loaded","error":"no boot loader answers"})");
    EXPECT_EQ(refused->status(), 409);
    EXPECT_EQ(refused->detail(), "no boot loader answers");
    const auto update = ask("POST", "/api/boards/uno1/load", R"({"update":true})");
    EXPECT_EQ(json::parse(published_.back().payload)["update"], true);
    for (const char* body :
         {"[]", R"({"port":"release"})", R"({"update":1})", R"({"firmware":1})", R"({"force":"yes"})"})
        EXPECT_EQ(ask("POST", "/api/boards/uno1/load", body)->status(), 400) << body;
    EXPECT_EQ(ask("POST", "/api/boards/none/load", "{}")->status(), 404);
}

TEST_F(ApiTest, Labels_GoToTheBoardsAgent_WhichHasTheLastWord) {
    announce();
    const auto change =
        R"({"labels":{"name":"left desk","room":null},"names":{"pins":{"13":"status lamp"}}})";
    const auto sent = ask("POST", "/api/boards/uno1/labels", change);
    ASSERT_EQ(published_.size(), 1u);
    EXPECT_EQ(published_[0].topic, "asip/uno1/in");
    const auto payload = json::parse(published_[0].payload);
    EXPECT_EQ(payload["labels"], json::parse(change)["labels"]);
    EXPECT_EQ(payload["names"], json::parse(change)["names"]);
    answer(R"({"status":"ok","proof":"kept","answer":{"labels":{"name":"left desk"}}})");
    EXPECT_EQ(sent->status(), 200);
    EXPECT_EQ(sent->body()["answer"]["labels"]["name"], "left desk");
    const auto refused = ask("POST", "/api/boards/uno1/labels", R"({"names":{"pins":{"99":"x"}}})");
    answer(R"({"status":"refused","reason":"invalid","error":"it has no pin 99"})");
    EXPECT_EQ(refused->status(), 400);
    EXPECT_EQ(refused->detail(), "it has no pin 99");
}

TEST_F(ApiTest, LabelsOfAnotherForm_AreRefusedBeforeTheyAreSent) {
    announce();
    for (const char* body : {"", "{}", "[]", R"({"labels":"x"})", R"({"labels":{},"resume":true})",
                             R"({"raw":"I,d,13,1"})", R"({"labels":{},"reply_to":"elsewhere"})"})
        EXPECT_EQ(ask("POST", "/api/boards/uno1/labels", body)->status(), 400) << body;
    EXPECT_EQ(ask("POST", "/api/boards/none/labels", R"({"labels":{}})")->status(), 404);
    bus("asip/servicebus/uno1/$state", "offline");
    EXPECT_EQ(ask("POST", "/api/boards/uno1/labels", R"({"labels":{"a":"b"}})")->status(), 503);
    EXPECT_TRUE(published_.empty());
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

TEST_F(ApiTest, OneServicesOwnModelIsWrong_TheOthersHaveTheirs) {
    bus("asip/servicebus/uno1/$description",
        R"({"board":"uno1","session":"s1","seq":1,"lease":60,"services":[)"
        R"({"name":"servo","id":"S","model":"servo@1"},)"
        R"({"name":"fan","id":"F","model":{"name":"X","version":1,"id":"F","commands":{}}}]})");
    bus("asip/servicebus/uno1/$state", "online");
    EXPECT_EQ(ask("POST", "/api/boards/uno1/services/servo/commands/write", "[0,181]")->status(), 400);
    EXPECT_EQ(ask("POST", "/api/boards/uno1/services/servo/commands/write", "[0,90]")->status(), 0);
    EXPECT_EQ(ask("POST", "/api/boards/uno1/services/fan/commands/go", "[1]")->status(), 404);
    EXPECT_EQ(get("/api/boards/uno1/services/servo")->body()["model"]["name"], "servo");
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

TEST_F(ApiTest, QueueToTheBrokerFull_IsAnsweredAtOnceAndCanBeSentAgain) {
    announce();
    const std::string path = "/api/boards/uno1/services/servo/commands/write";
    queue_full_ = true;
    const auto full = ask("POST", path, "[0,90]", {{"idempotency-key", "k1"}});
    const auto raw = ask("POST", "/api/boards/uno1/raw", R"({"lines":["I,d,13,1"]})");
    const auto stop = ask("POST", "/api/boards/uno1/stop");
    pass(0ms);
    ASSERT_EQ(full->status(), 429);
    EXPECT_EQ(full->header("Retry-After"), "1");
    EXPECT_EQ(full->body()["reason"], "queue-full");
    EXPECT_THAT(full->detail(), HasSubstr("was not sent"));
    EXPECT_EQ(get("/api/commands/k1")->body()["answer"]["reason"], "queue-full");
    EXPECT_EQ(raw->status(), 429);
    EXPECT_EQ(stop->status(), 207);
    queue_full_ = false;
    const auto again = ask("POST", path, "[0,90]", {{"idempotency-key", "k1"}});
    ASSERT_EQ(again->status(), 0) << "it is on its way";
    answer(R"({"status":"ok","proof":"fence"})");
    EXPECT_EQ(again->status(), 200);
}

// Steps of work in front of a stop, not milliseconds: no message of another command, and none to a board that
// is lost.
TEST_F(ApiTest, StopOfAllBehindAllCommandsThatMayWait_IsTheNextMessageOfEachBoardThatIsThere) {
    for (const char* board : {"a-lost", "b-there", "c-lost", "d-there"})
        announce(board);
    for (const char* board : {"a-lost", "c-lost"})
        bus(std::string("asip/servicebus/") + board + "/$state", "lost");
    for (int i = 0; i < 2000; ++i)
        ask("POST", "/api/boards/b-there/services/servo/commands/write", "[0,90]");
    const auto before = published_.size();
    ASSERT_GE(before, 100u) << "as many as may wait for their answers";
    ask("POST", "/api/stop");
    ASSERT_EQ(published_.size(), before + 4);
    std::vector<std::string> topics;
    for (auto i = before; i < published_.size(); ++i)
        topics.push_back(published_[i].topic);
    EXPECT_THAT(topics, testing::ElementsAre("asip/b-there/$stop", "asip/d-there/$stop", "asip/a-lost/$stop",
                                             "asip/c-lost/$stop"));
}

TEST_F(ApiTest, StopOfNamedBoards_StopsThoseInOneRequest_AndNamesTheUnknown) {
    for (const char* board : {"a", "b", "c"})
        announce(board);
    const auto before = published_.size();
    const auto asked = ask("POST", "/api/stop", R"({"boards":["c","a","nowhere","a"]})");
    ASSERT_EQ(published_.size(), before + 2) << "of each board one";
    EXPECT_EQ(published_[before].topic, "asip/a/$stop");
    EXPECT_EQ(published_[before + 1].topic, "asip/c/$stop");
    EXPECT_EQ(asked->status(), 0) << "it waits for the boards";
    EXPECT_EQ(ask("POST", "/api/resume", R"({"boards":["b"]})")->status(), 0);
    EXPECT_EQ(published_.back().topic, "asip/b/in");

    const auto unknown = ask("POST", "/api/stop", R"({"boards":["nowhere"]})");
    EXPECT_EQ(unknown->status(), 207);
    EXPECT_EQ(unknown->body()["boards"]["nowhere"]["reason"], "unknown-board");
    EXPECT_EQ(ask("POST", "/api/stop", R"({"boards":[]})")->body()["boards"], json::object());
}

TEST_F(ApiTest, StopWithABodyThatNamesBoardsWrongly_IsRefusedAndStopsNoBoard) {
    announce("a");
    const auto before = published_.size();
    for (const char* body : {R"({"boards":"a"})", R"({"boards":[7]})", R"({"board":["a"]})", R"(["a"])", "a"})
        for (const char* path : {"/api/stop", "/api/resume"})
            EXPECT_EQ(ask("POST", path, body)->status(), 400) << path << " " << body;
    EXPECT_EQ(published_.size(), before);
    ask("POST", "/api/stop", "{}");
    EXPECT_EQ(published_.size(), before + 1) << "the next one stops all";
}

TEST_F(ApiTest, QueueToTheBrokerFull_AWebSocketIsAnsweredAtOnce) {
    announce();
    const auto socket = ask("GET", "/api/stream", "",
                            {{"upgrade", "websocket"},
                             {"connection", "Upgrade"},
                             {"sec-websocket-version", "13"},
                             {"sec-websocket-key", "dGhlIHNhbXBsZSBub25jZQ=="}});
    ASSERT_TRUE(socket->channel);
    queue_full_ = true;
    socket->channel->received(R"({"command":"uno1/servo","write":[0,90],"id":"7"})");
    pass(0ms);
    std::string text;
    ASSERT_TRUE(socket->channel->take(text));
    const auto refused = json::parse(text);
    EXPECT_EQ(refused["id"], "7");
    EXPECT_EQ(refused["status"], "refused");
    EXPECT_EQ(refused["reason"], "queue-full");
    queue_full_ = false;
    socket->channel->received(R"({"command":"uno1/servo","renew":true,"id":"7"})");
    EXPECT_EQ(published_.size(), 1u);
    queue_full_ = true;
    socket->channel->received(R"({"command":"uno1/servo","renew":true,"id":"7"})");
    pass(0ms);
    ASSERT_TRUE(socket->channel->take(text)) << text;
    EXPECT_EQ(json::parse(text)["reason"], "queue-full");
}

TEST_F(ApiTest, QueueToTheBrokerFull_ARegistryIsNotWaitedFor) {
    announce();
    queue_full_ = true;
    const auto history = get("/api/boards/uno1/history");
    pass(1ms);
    EXPECT_EQ(history->status(), 503);
}

TEST_F(ApiTest, BrokerThatDeniesACommand_IsAnsweredAtOnce) {
    announce();
    const auto sent = ask("POST", "/api/boards/uno1/services/servo/commands/write", "[0,90]");
    gateway_->denied("asip/uno1/servo/in", "Not authorized");
    ASSERT_EQ(sent->status(), 409);
    EXPECT_EQ(sent->body()["reason"], "denied");
    EXPECT_THAT(sent->detail(), HasSubstr("does not let user gate write to asip/uno1/servo/in"));
}

TEST_F(ApiTest, ConnectionThatIsNotBackInTime_IsWhatTheTimeoutSays) {
    announce();
    const auto sent = ask("POST", "/api/boards/uno1/services/servo/commands/write?deadline_ms=100", "[0,90]");
    mqtt::ConnectionFailure why;
    why.text = "mqtt://hub:1883 closed the connection";
    gateway_->cannot_call(why);
    pass(600ms);
    ASSERT_EQ(sent->status(), 504);
    EXPECT_EQ(sent->body()["reason"], "connection");
    EXPECT_EQ(sent->detail(),
              "mqtt://hub:1883 closed the connection, and was not back in time; it may or may not have been "
              "executed");
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
    gateway_->message(mqtt::Message{
        .topic = published_[0].response_topic,
        .payload = R"({"registry":"r","epoch":"e","seq":2,"forgotten":["uno1"],"items":[],"find":"boards"})",
        .correlation = published_[0].correlation});
    EXPECT_EQ(forgotten->status(), 200);
    EXPECT_EQ(forgotten->body()["forgotten"][0], "uno1");
    const auto nobody = ask("DELETE", "/api/boards/uno1");
    pass(3s);
    EXPECT_EQ(nobody->status(), 503) << "no registry answers";
}

}  // namespace
}  // namespace asip::gateway
