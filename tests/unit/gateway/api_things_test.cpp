// SPDX-License-Identifier: Apache-2.0
// The Web of Things over HTTP.
#include "api_bench.hpp"
#include "gateway/api/things.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr const char* kAngle = "/things/uno1/properties/servo-0-angle";

class ThingsApi : public ApiTest {
  protected:
    explicit ThingsApi(Role role = Role::kAdmin) : ApiTest(role) {}

    void announce_with_motors() {
        bus("asip/servicebus/uno1/$description",
            R"({"board":"uno1","session":"s1","seq":2,"lease":60,"services":[)"
            R"({"name":"servo","id":"S","model":"servo@1","title":"Servos"},)"
            R"({"name":"motors","id":"M","model":"motors@1","title":"Motors","count":2}]})");
        bus("asip/servicebus/uno1/$state", "online");
    }
    std::string text(const std::shared_ptr<Captured>& captured) {
        std::string out;
        captured->source->take(out, 65536);
        return out;
    }
};

TEST_F(ThingsApi, EachBoardIsAThing_PageByPage) {
    for (const char* board : {"uno1", "uno2", "uno3"})
        announce(board);
    const auto page = get("/things?limit=2");
    EXPECT_EQ(page->status(), 200);
    EXPECT_EQ(page->response->content_type, "application/ld+json");
    EXPECT_EQ(page->body().size(), 2u);
    EXPECT_EQ(page->header("Link"), "</things?offset=2&limit=2>; rel=\"next\"");
    EXPECT_EQ(page->steps, 3u) << "others are served between two things";
    const auto last = get("/things?offset=2&limit=2");
    EXPECT_EQ(last->body()[0]["id"], "urn:asip:asip:uno3");
    EXPECT_EQ(last->header("Link"), "");
    EXPECT_EQ(get("/things?offset=99")->body(), json::array());
    EXPECT_EQ(get("/things?limit=0")->status(), 400);
    EXPECT_EQ(get("/things?offset=-1")->status(), 400);
    const auto thing = get("/things/urn%3Aasip%3Aasip%3Auno2");
    EXPECT_EQ(thing->response->content_type, "application/td+json");
    EXPECT_EQ(thing->body()["title"], "uno2");
    EXPECT_EQ(thing->body()["base"], "http://localhost/");
    EXPECT_THAT(get("/things/uno4")->detail(), HasSubstr("did you mean"));
    EXPECT_EQ(get("/things/uno2/what")->status(), 404);
    EXPECT_EQ(get("/.well-known/wot")->body()["@type"], "ThingDirectory");
}

TEST_F(ThingsApi, ChangedDescription_IsAnotherThing) {
    announce();
    EXPECT_FALSE(get("/things/uno1")->body().contains("actions"));
    announce_with_motors();
    EXPECT_TRUE(get("/things/uno1")->body()["actions"].contains("motors-stop"));
}

/// Exports read the parts of a light.
TEST_F(ThingsApi, ValueOfAnotherKind_IsNotShown) {
    announce();
    bus("asip/servicebus/uno1/$properties",
        R"({"version":1,"board":"uno1","session":"s1","seq":1,"properties":[)"
        R"({"id":"servo/0/lamp","kind":"light","write":["write",0,null]},)"
        R"({"id":"servo/1/angle","min":0,"max":180,"write":["write",1,null]}]})");
    const auto values = [&](const std::string& lamp, const std::string& angle) {
        bus("asip/uno1/$values",
            R"({"version":1,"board":"uno1","session":"s1","seq":1,"values":{"servo/0/lamp":{"how":"set","value":)" +
                lamp + R"(},"servo/1/angle":{"how":"set","value":)" + angle + "}}}");
        const auto shown = get("/api/boards/uno1/values")->body()["values"];
        return std::pair(shown["servo/0/lamp"].contains("value"), shown["servo/1/angle"].contains("value"));
    };
    EXPECT_EQ(values(R"({"on":true})", "9"), std::pair(true, true));
    for (const char* wrong : {"true", "9", R"("on")"})
        EXPECT_EQ(values(wrong, R"({"on":true})"), std::pair(false, false)) << wrong;
}

TEST_F(ThingsApi, PropertyThatIsRead_IsTheLastValue) {
    announce();
    bus("asip/uno1/distance/out", R"({"distance":{"0":42}})");
    const auto read = get("/things/uno1/properties/distance-0");
    EXPECT_EQ(read->status(), 200);
    EXPECT_EQ(read->body(), 42);
    EXPECT_EQ(get("/things/uno1/properties/board-state")->body(), "online");
    EXPECT_THAT(get(kAngle)->detail(), HasSubstr("has no value yet"));
    bus("asip/uno1/$values", R"({"version":1,"board":"uno1","session":"s1","seq":1,)"
                             R"("values":{"servo/0/angle":{"value":90,"how":"set","age":0}}})");
    EXPECT_EQ(get(kAngle)->body(), 90);
    EXPECT_EQ(get("/things/uno1/properties")->body(),
              json::parse(R"({"board-state":"online","distance-0":42,"servo-0-angle":90})"));
    EXPECT_THAT(get("/things/uno1/properties/distance-1")->detail(), HasSubstr("did you mean"));
}

TEST_F(ThingsApi, OldValue_IsReplacedByTheNextOne_OrIsTheAnswerAfterASecond) {
    announce();
    bus("asip/uno1/distance/out", R"({"distance":{"0":42}})");
    pass(std::chrono::seconds(5));
    const auto first = get("/things/uno1/properties/distance-0");
    EXPECT_EQ(first->status(), 0) << "it waits";
    bus("asip/uno1/distance/out", R"({"distance":{"0":43}})");
    pass(std::chrono::milliseconds(100));
    EXPECT_EQ(first->body(), 43);
    pass(std::chrono::seconds(5));
    EXPECT_EQ(get("/things/uno1/properties/distance-0")->body(), 43) << "its reports are demanded meanwhile";
    pass(std::chrono::seconds(40));
    const auto alone = get("/things/uno1/properties/distance-0");
    EXPECT_EQ(alone->status(), 0);
    pass(std::chrono::milliseconds(1100));
    EXPECT_EQ(alone->body(), 43);
}

TEST_F(ThingsApi, PropertyThatIsSet_IsAnsweredWhenTheBoardDid) {
    announce();
    const std::vector<std::pair<std::string, int>> answers{
        {R"({"status":"ok","proof":"fence"})", 204},
        {R"({"status":"error","code":7,"error":"INVALID_DEVICE_NUMBER"})", 422},
        {R"({"status":"refused","reason":"queue-full","error":"x"})", 429},
        {R"({"status":"refused","reason":"stopped","error":"x"})", 409},
        {R"({"status":"timeout","reason":"doubt"})", 504},
    };
    for (const auto& [payload, status] : answers) {
        const auto sent = ask("PUT", kAngle, "90");
        ASSERT_EQ(sent->status(), 0);
        EXPECT_EQ(published_.back().topic, "asip/uno1/servo/in");
        EXPECT_EQ(json::parse(published_.back().payload)["write"], json({0, 90}));
        answer(payload);
        EXPECT_EQ(sent->status(), status) << payload;
    }
    for (const char* wrong : {"181", "1.5", "\"90\"", "null", "", "[", "[90]", "{}"})
        EXPECT_EQ(ask("PUT", kAngle, wrong)->status(), 400) << wrong;
    EXPECT_EQ(ask("PUT", "/things/uno1/properties/distance-0", "1")->status(), 400) << "it cannot be set";
    EXPECT_EQ(ask("PUT", "/things/uno1", "{}")->status(), 405);
    bus("asip/servicebus/uno1/$state", "offline");
    EXPECT_EQ(ask("PUT", kAngle, "90")->status(), 503);
}

TEST_F(ThingsApi, Action_HasTheStatusOfItsCommand) {
    announce_with_motors();
    const std::vector<std::pair<std::string, int>> answers{
        {R"({"status":"ok","proof":"fence"})", 204},
        {R"({"status":"error","code":7,"error":"x"})", 422},
        {R"({"status":"refused","reason":"queue-full","error":"x"})", 429},
        {R"({"status":"refused","reason":"stopped","error":"x"})", 409},
        {R"({"status":"refused","reason":"board-not-there","error":"x"})", 503},
        {R"({"status":"timeout","reason":"doubt"})", 504},
    };
    for (const auto& [payload, status] : answers) {
        const auto sent = ask("POST", "/things/uno1/actions/motors-stop");
        ASSERT_EQ(sent->status(), 0);
        EXPECT_EQ(published_.back().topic, "asip/uno1/motors/in");
        answer(payload);
        EXPECT_EQ(sent->status(), status) << payload;
    }
    EXPECT_EQ(ask("POST", "/things/uno1/actions/servo-0-angle")->status(), 404) << "a property";
}

TEST_F(ThingsApi, ObservedProperty_IsSentWhenItChanges) {
    announce();
    bus("asip/uno1/distance/out", R"({"distance":{"0":42}})");
    const auto stream = get("/things/uno1/properties/distance-0/stream");
    ASSERT_TRUE(stream->source);
    EXPECT_THAT(text(stream), HasSubstr("event: message\ndata: 42\n"));
    bus("asip/uno1/distance/out", R"({"distance":{"0":42}})");
    pass(std::chrono::seconds(1));
    EXPECT_THAT(text(stream), testing::Not(HasSubstr("data:")));
    bus("asip/uno1/distance/out", R"({"distance":{"0":7}})");
    bus("asip/uno1/distance/error", "1");
    pass(std::chrono::seconds(1));
    EXPECT_THAT(text(stream), HasSubstr("data: 7\n"));
}

TEST_F(ThingsApi, ThingsThatComeChangeAndGo_AreEvents) {
    announce("uno0");
    const auto all = get("/events");
    const auto deleted = get("/events/thing_deleted");
    ASSERT_TRUE(all->source && deleted->source);
    announce();
    announce_with_motors();
    const auto seen = text(all);
    EXPECT_THAT(seen, HasSubstr("event: thing_created\ndata: {\"id\":\"urn:asip:asip:uno1\"}\n"));
    EXPECT_THAT(seen, HasSubstr("event: thing_updated\n"));
    EXPECT_THAT(seen, testing::Not(HasSubstr("uno0"))) << "it was there before";
    EXPECT_THAT(text(deleted), testing::Not(HasSubstr("data:")));
    bus("asip/servicebus/uno1/$state", "");
    bus("asip/servicebus/uno1/$description", "");
    pass(std::chrono::hours(8 * 24));
    EXPECT_THAT(text(deleted), HasSubstr("event: thing_deleted\n"));
    EXPECT_EQ(get("/events/thing_eaten")->status(), 404);
}

class ViewersThings : public ThingsApi {
  protected:
    ViewersThings() : ThingsApi(Role::kViewer) {}
};

TEST_F(ViewersThings, MayReadAndNothingElse) {
    announce();
    const auto thing = get("/things/uno1")->body();
    EXPECT_EQ(thing["properties"]["servo-0-angle"]["readOnly"], true);
    EXPECT_EQ(ask("PUT", kAngle, "90")->status(), 403);
    EXPECT_EQ(ask("POST", "/things/uno1/actions/x")->status(), 403);
    EXPECT_TRUE(published_.empty());
}

TEST_F(ApiTest, ValuesKeptByTwoRegistries_TheLongestCountsAndIsNamed) {
    announce();
    for (const char* id : {"r1", "r2", "r3"})
        bus(std::string("asip/registry/") + id + "/$state", id == std::string("r3") ? "lost" : "online");
    const auto answer_of = [this](std::size_t question, const std::string& payload) {
        const auto& asked = published_.at(question);
        gateway_->message(mqtt::Message{
            .topic = asked.response_topic, .payload = payload, .correlation = asked.correlation});
    };
    const auto kept_since = [](const std::string& id, const std::string& time) {
        return R"({"registry":")" + id + R"(","find":"values","level":"hours","items":[["2026-11-21T)" +
               time + R"(:00:00.000Z",40,42,44]]})";
    };
    const std::string target =
        "/api/boards/uno1/values/kept?property=distance/"
        "0&from=2026-11-20T12:00:00.000Z&to=2026-11-21T12:00:00.000Z";
    settle();
    const auto both = get(target);
    ASSERT_EQ(published_.size(), 2u) << "a lost one is not asked";
    EXPECT_EQ(published_[0].topic, "asip/registry/r1/query");
    EXPECT_EQ(published_[1].topic, "asip/registry/r2/query");
    answer_of(1, kept_since("r2", "02"));
    EXPECT_EQ(both->status(), 0);
    answer_of(0, kept_since("r1", "08"));
    ASSERT_EQ(both->status(), 200) << both->detail();
    EXPECT_EQ(both->body()["registry"], "r2");

    published_.clear();
    const auto one_is_silent = get(target);
    answer_of(1, kept_since("r2", "08"));
    pass(4s);
    EXPECT_EQ(one_is_silent->status(), 200);

    published_.clear();
    const auto one_keeps_nothing = get(target);
    answer_of(0, kept_since("r1", "08"));
    answer_of(1, R"({"registry":"r2","refused":"no-history","error":"none is kept"})");
    EXPECT_EQ(one_keeps_nothing->body()["registry"], "r1");

    const auto nobody = get(target);
    pass(4s);
    EXPECT_EQ(nobody->status(), 503);
}

}  // namespace
}  // namespace asip::gateway
