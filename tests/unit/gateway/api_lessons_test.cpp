// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <functional>
#include <map>

#include "api_bench.hpp"
#include "gateway/api/routes.hpp"
#include "gateway/auth/secret.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using Headers = std::vector<std::pair<std::string, std::string>>;

/// A teacher and somebody who may only read, by their tokens; the others come without one.
class LessonsApi : public ApiTest {
  protected:
    explicit LessonsApi(Role loopback = Role::kNone) : ApiTest(loopback) {
        set_tokens();
        for (const char* board : {"student-1", "student-2", "student-10", "teachers"})
            announce(board);
    }
    void set_tokens(const std::string& teacher = "teach") {
        gateway_->gate().set_tokens(*Tokens::parse("operator miss " + hash_of(teacher) + "\nviewer hall " +
                                                   hash_of("see") + "\noperator anna " + hash_of("part") +
                                                   " boards=student-*\n"));
    }
    std::shared_ptr<Captured> as(const std::string& token, const std::string& method,
                                 const std::string& target, const std::string& body = {}) {
        return ask(method, target, body, {{"authorization", "Bearer " + token}});
    }
    json open(const std::string& body = R"({"boards":["student-*"],"minutes":45})") {
        const auto opened = as("teach", "POST", "/api/lessons", body);
        EXPECT_EQ(opened->status(), 201) << opened->detail();
        return opened->body();
    }
    std::shared_ptr<Captured> join(const std::string& code, const std::string& cookie = {}) {
        Headers headers;
        if (!cookie.empty()) headers.emplace_back("cookie", cookie);
        return ask("POST", "/api/join", json{{"code", code}}.dump(), headers);
    }
    /// "asip=VALUE"
    static std::string cookie_of(const std::shared_ptr<Captured>& joined) {
        const auto header = joined->header("Set-Cookie");
        return header.substr(0, header.find(';'));
    }
    std::string pupil() { return cookie_of(join(lesson_["code"])); }
    std::shared_ptr<Captured> with(const std::string& cookie, const std::string& method,
                                   const std::string& target, const std::string& body = {}) {
        return ask(method, target, body, {{"cookie", cookie}});
    }
    std::string path() const { return "/api/lessons/" + lesson_["id"].get<std::string>(); }

    json lesson_;
};

TEST_F(LessonsApi, Opened_HasACodeAndTheBoardsOfThatMoment) {
    const auto lesson = open();
    std::vector<std::string> boards;
    for (const auto& each : lesson["boards"])
        boards.push_back(each["board"]);
    EXPECT_EQ(boards, (std::vector<std::string>{"student-1", "student-2", "student-10"}));
    EXPECT_EQ(lesson["path"], "#/join/" + lesson["code"].get<std::string>());
    EXPECT_EQ(lesson["by"], "miss");
    EXPECT_EQ(lesson["free"], 3);
    EXPECT_EQ(lesson["until"], text::iso_time(at(45min).wall));
    EXPECT_EQ(as("teach", "GET", "/api/lessons")->body()["items"], json::array({lesson}));
    announce("student-3");
    EXPECT_EQ(as("teach", "GET", "/api/lessons/" + lesson["id"].get<std::string>())->body(), lesson)
        << "what comes later is none of it";
}

TEST_F(LessonsApi, Request_IsReadOrRefusedWithASentence) {
    for (const char* wrong :
         {"", "[]", "{}", R"({"boards":[]})", R"({"boards":"student-1"})", R"({"boards":[1]})",
          R"({"boards":["student-1"],"labels":"class=4b"})", R"({"boards":["student-1"],"minutes":0})",
          R"({"boards":["student-1"],"minutes":481})", R"({"boards":["student-1"],"minutes":1.5})",
          R"({"boards":["student-1"],"code":"CDFHJK"})", R"({"labels":"=4b"})"}) {
        EXPECT_EQ(as("teach", "POST", "/api/lessons", wrong)->status(), 400) << wrong;
    }
    EXPECT_EQ(as("teach", "POST", "/api/lessons", R"({"boards":["nobody-*"]})")->status(), 404);
    EXPECT_EQ(as("teach", "POST", "/api/lessons", R"({"labels":"class=4b"})")->status(), 404);
    open(R"({"boards":["student-1"]})");
    EXPECT_EQ(as("teach", "POST", "/api/lessons", R"({"boards":["student-1"]})")->status(), 409);
    EXPECT_EQ(open()["free"], 2) << "a pattern passes over what another lesson has";
}

TEST_F(LessonsApi, ByLabels_AreThoseThatHaveThemWhenItOpens) {
    const auto label = [&](const std::string& board) {
        bus("asip/servicebus/" + board + "/$description",
            R"({"board":")" + board +
                R"(","session":"s1","seq":2,"lease":60,"labels":{"class":"4b"},"services":[)"
                R"({"name":"servo","id":"S","model":"servo@1","title":"Servos"}]})");
    };
    label("student-2");
    lesson_ = open(R"({"labels":"class=4b"})");
    EXPECT_EQ(lesson_["boards"].size(), 1u);
    const auto cookie = pupil();
    label("student-1");
    EXPECT_EQ(with(cookie, "GET", "/api/boards/student-1")->status(), 404) << "a later label gives no right";
    EXPECT_EQ(join(lesson_["code"])->status(), 409);
}

TEST_F(LessonsApi, OnlyATeacher_HoldsLessons) {
    lesson_ = open();
    const auto pupils = pupil();
    const auto refused = [&](const std::function<std::shared_ptr<Captured>(
                                 const std::string&, const std::string&, const std::string&)>& ask_as) {
        for (const auto& [method, target, body] :
             std::vector<std::array<std::string, 3>>{{"GET", "/api/lessons", ""},
                                                     {"POST", "/api/lessons", R"({"boards":["*"]})"},
                                                     {"GET", path(), ""},
                                                     {"POST", path() + "/take", R"({"board":"student-2"})"},
                                                     {"DELETE", path(), ""}}) {
            const auto answer = ask_as(method, target, body);
            EXPECT_TRUE(answer->status() == 401 || answer->status() == 403) << method << " " << target;
            EXPECT_THAT(std::string(answer->response->text()), Not(HasSubstr(lesson_["code"])));
        }
    };
    for (const char* token : {"see", "part"})
        refused([&](const auto&... words) { return as(token, words...); });
    refused([&](const auto&... words) { return with(pupils, words...); });
    refused([&](const auto&... words) { return ask(words...); });
    EXPECT_EQ(as("teach", "GET", path())->body()["free"], 2) << "nothing was taken";
}

TEST_F(LessonsApi, Pupil_IsShownAndCommandsOneBoard) {
    lesson_ = open();
    const auto joined = join(lesson_["code"]);
    ASSERT_EQ(joined->status(), 200) << joined->detail();
    EXPECT_EQ(
        joined->body(),
        (json{{"pupil", "student-1"}, {"board", "student-1"}, {"lend", false}, {"until", lesson_["until"]}}));
    EXPECT_THAT(joined->header("Set-Cookie"), HasSubstr("HttpOnly; SameSite=Strict"));
    const auto cookie = cookie_of(joined);
    const auto you = with(cookie, "GET", "/api/status")->body()["you"];
    EXPECT_EQ(you["lesson"], joined->body());
    for (const char* right : {"command", "stop", "limited"})
        EXPECT_EQ(you[right], true) << right;
    for (const char* right : {"raw", "label", "resume", "forget", "arrange"})
        EXPECT_EQ(you[right], false) << right;
    EXPECT_EQ(with(cookie, "GET", "/api/boards")->body()["items"].size(), 1u);
    with(cookie, "POST", "/api/boards/student-1/services/servo/commands/write", "[0,90]");
    ASSERT_EQ(published_.size(), 1u);
    EXPECT_EQ(json::parse(published_[0].payload)["by"], "student-1@" + lesson_["id"].get<std::string>());
    const auto seen = as("teach", "GET", path())->body();
    EXPECT_EQ(seen["free"], 2);
    EXPECT_EQ(seen["boards"][0]["pupil"], "student-1");
    EXPECT_EQ(seen["boards"][0]["since"], text::iso_time(at(0ms).wall));
}

// Each route that there is, also one that comes later.
TEST_F(LessonsApi, EveryRoute_ShowsAndDoesNothingOfAnothersBoard) {
    lesson_ = open();
    const auto one = pupil();
    const auto two = pupil();
    ASSERT_EQ(with(two, "GET", "/api/boards/student-2")->status(), 200) << "it is there";
    published_.clear();
    const std::map<std::string, std::string> bodies{
        {"/api/stop", R"({"boards":["student-2"]})"},
        {"/api/resume", R"({"boards":["student-2"]})"},
        {"/api/boards/{board}/values", R"({"servo/0/angle":90})"},
        {"/api/boards/{board}/raw", R"({"lines":["x"]})"},
        {"/api/boards/{board}/labels", R"({"labels":{"a":"b"}})"},
        {"/api/boards/{board}/links",
         R"({"set":{"name":"l","from":"student-1/distance/0","to":"servo/0/angle"}})"}};
    for (const auto& route : api::routes()) {
        std::string target(route.path);
        if (target == "/api/session" || target == "/api/openapi.json") continue;
        for (const auto& [name, value] : std::map<std::string, std::string>{{"{board}", "student-2"},
                                                                            {"{service}", "servo"},
                                                                            {"{command}", "write"},
                                                                            {"{property}", "servo-0-angle"},
                                                                            {"{action}", "none"},
                                                                            {"{type}", "thing_created"},
                                                                            {"{dashboard}", "lab"},
                                                                            {"{id}", "student-2"},
                                                                            {"{name}", "servo"},
                                                                            {"{lesson}", lesson_["id"]}})
            if (const auto place = target.find(name); place != std::string::npos)
                target.replace(place, name.size(), value);
        const auto body = bodies.find(std::string(route.path));
        const auto answer = with(one, std::string(route.method), target,
                                 body != bodies.end()    ? body->second
                                 : route.method == "GET" ? ""
                                                         : "[0,90]");
        const bool own_words = target.find("student-2") != std::string::npos || body != bodies.end();
        if (!answer->response) {
            EXPECT_EQ(route.path, "/api/history") << "a registry is asked, whose answer is limited";
            continue;
        }
        std::string text(answer->response->text());
        if (answer->source) answer->source->take(text, 100'000);
        if (!own_words) {
            EXPECT_THAT(text, Not(HasSubstr("student-2"))) << route.method << " " << target;
            EXPECT_THAT(text, Not(HasSubstr("teachers"))) << route.method << " " << target;
        } else if (route.path != "/api/stop") {
            EXPECT_GE(answer->status(), 400) << route.method << " " << target << ": " << text;
        }
    }
    for (const auto& message : published_)
        EXPECT_THAT(message.topic, Not(HasSubstr("student-2"))) << message.payload;
    Principal principal{*gateway_->gate().lessons(at(time_)).rights_of(one.substr(5), at(time_)),
                        Principal::Kind::kSession, one.substr(5)};
    std::string said;
    api::websocket_command(*gateway_, principal, "pupil", "one",
                           json{{"command", "student-2/servo"}, {"write", {0, 90}}, {"id", "1"}},
                           [&](const std::string& answer) { said = answer; });
    EXPECT_THAT(said, HasSubstr("no board"));
}

TEST_F(LessonsApi, Pupil_MakesNothingThatOutlastsTheLesson) {
    lesson_ = open();
    const auto cookie = pupil();
    published_.clear();
    for (const auto& [method, target, body] : std::vector<std::array<std::string, 3>>{
             {"POST", "/api/codes", "{}"},
             {"PUT", "/api/dashboards/mine", R"({"widgets":[]})"},
             {"POST", "/api/dashboards/mine/links", "{}"},
             {"POST", "/api/boards/student-1/labels", R"({"labels":{"class":"4b"}})"},
             {"POST", "/api/boards/student-1/load", "{}"},
             {"POST", "/api/boards/student-1/raw", R"({"lines":["x"]})"},
             {"POST", "/api/boards/student-1/links",
              R"({"set":{"name":"l","from":"student-1/distance/0","to":"servo/0/angle"}})"},
             {"POST", "/api/boards/student-1/resume", "{}"},
             {"POST", "/api/resume", "{}"},
             {"DELETE", "/api/boards/student-1", ""}}) {
        const auto refused = with(cookie, method, target, body);
        EXPECT_EQ(refused->status(), 403) << method << " " << target;
    }
    EXPECT_TRUE(published_.empty());
    with(cookie, "POST", "/api/boards/student-1/stop", "{}");
    with(cookie, "POST", "/api/stop", R"({"boards":["student-1"]})");
    ASSERT_EQ(published_.size(), 2u);
    for (const auto& message : published_)
        EXPECT_THAT(message.payload, Not(HasSubstr("latch"))) << "the pupil could not take it back";
    as("teach", "POST", "/api/stop", R"({"boards":["student-1"]})");
    EXPECT_THAT(published_.back().payload, HasSubstr("latch"));
}

TEST_F(LessonsApi, SameBrowser_HasItsBoardAgain_AndOneThatIsSignedInIsAsked) {
    lesson_ = open();
    const auto cookie = pupil();
    const auto again = join(lesson_["code"], cookie);
    EXPECT_EQ(again->body()["board"], "student-1");
    EXPECT_EQ(cookie_of(again), cookie);
    const auto code = as("teach", "POST", "/api/codes", "{}")->body()["code"].get<std::string>();
    const auto signed_in = cookie_of(get("/?code=" + code));
    EXPECT_EQ(join(lesson_["code"], signed_in)->status(), 409);
    EXPECT_EQ(with(signed_in, "GET", "/api/status")->body()["you"]["name"], "miss");
}

TEST_F(LessonsApi, PupilsLend_WhereAnAgentTakesLentBoards) {
    const auto refused = as("teach", "POST", "/api/lessons", R"({"lend":true})");
    EXPECT_EQ(refused->status(), 404);
    EXPECT_THAT(refused->detail(), HasSubstr("no agent takes lent boards here"));
    for (const char* wrong :
         {R"({"lend":false})", R"({"lend":1})", R"({"lend":true,"boards":["student-1"]})"})
        EXPECT_EQ(as("teach", "POST", "/api/lessons", wrong)->status(), 400) << wrong;
    lesson_ = open();
    EXPECT_EQ(lesson_["lend"], false);
    EXPECT_EQ(join(lesson_["code"])->body()["lend"], false);
    const auto cable = with(pupil(), "GET", "/api/cable");
    EXPECT_EQ(cable->status(), 403) << "a pupil of a lesson on the room's boards";
}

TEST_F(LessonsApi, LastBoard_GoesToOneOfTwo) {
    lesson_ = open(R"({"boards":["student-1"]})");
    const auto first = join(lesson_["code"]);
    const auto second = join(lesson_["code"]);
    EXPECT_EQ(first->status(), 200);
    EXPECT_EQ(second->status(), 409);
    EXPECT_THAT(second->detail(), HasSubstr("no board is free"));
    EXPECT_EQ(second->header("Set-Cookie"), "");
    EXPECT_EQ(with(cookie_of(first), "DELETE", "/api/session")->status(), 204);
    EXPECT_EQ(join(lesson_["code"])->status(), 200) << "who leaves gives the board back";
}

TEST_F(LessonsApi, WrongCodes_WaitWithRetryAfter) {
    lesson_ = open();
    for (int i = 0; i < 5; ++i)
        EXPECT_EQ(join("CCCCCC")->status(), 404);
    time_ += 10s;
    const auto refused = join(lesson_["code"]);
    EXPECT_EQ(refused->status(), 429);
    EXPECT_EQ(refused->header("Retry-After"), "50");
    for (const char* wrong : {"", "[]", "{}", R"({"code":1})", R"({"code":"C","more":1})"})
        EXPECT_EQ(ask("POST", "/api/join", wrong)->status(), 400) << wrong;
    time_ += 51s;
    EXPECT_EQ(join(lesson_["code"])->status(), 200);
}

TEST_F(LessonsApi, TakenOver_EndsRightsAndStreamsAtOnce) {
    lesson_ = open();
    const auto cookie = pupil();
    const auto stream = with(cookie, "GET", "/api/events");
    ASSERT_TRUE(stream->source);
    const auto taken = as("teach", "POST", path() + "/take", R"({"board":"student-1","keep":true})");
    ASSERT_EQ(taken->status(), 200) << taken->detail();
    EXPECT_EQ(taken->body()["boards"][0], (json{{"board", "student-1"}, {"kept", true}}));
    EXPECT_TRUE(stream->source->finished());
    const auto command =
        with(cookie, "POST", "/api/boards/student-1/services/servo/commands/write", "[0,90]");
    EXPECT_EQ(command->status(), 401);
    EXPECT_THAT(command->detail(), HasSubstr("the teacher has taken this board over"));
    EXPECT_EQ(command->body()["reason"], "lesson-over");
    EXPECT_EQ(join(lesson_["code"], cookie)->body()["board"], "student-2");
    EXPECT_EQ(as("teach", "POST", path() + "/take", R"({"board":"teachers"})")->status(), 404);
    for (const char* wrong : {"", "{}", R"({"board":1})", R"({"board":"student-1","keep":1})",
                              R"({"board":"student-1","more":true})"})
        EXPECT_EQ(as("teach", "POST", path() + "/take", wrong)->status(), 400) << wrong;
}

TEST_F(LessonsApi, Ended_EndsAllAtOnce_AndSoDoTheTeachersRights) {
    for (const bool by_token : {false, true}) {
        lesson_ = open();
        const auto cookie = pupil();
        const auto stream = with(cookie, "GET", "/api/events");
        ASSERT_TRUE(stream->source);
        if (by_token) {
            set_tokens("another");
            pass(1s);
        } else {
            EXPECT_EQ(as("teach", "DELETE", path())->status(), 204);
        }
        EXPECT_TRUE(stream->source->finished());
        EXPECT_EQ(with(cookie, "GET", "/api/boards")->status(), 401);
        EXPECT_EQ(join(lesson_["code"])->status(), 404);
        EXPECT_EQ(as(by_token ? "another" : "teach", "GET", path())->status(), 404);
        EXPECT_EQ(as(by_token ? "another" : "teach", "DELETE", path())->status(), 404);
    }
}

TEST_F(LessonsApi, TimeThatIsOver_EndsIt) {
    lesson_ = open(R"({"boards":["student-1"],"minutes":1})");
    const auto cookie = pupil();
    pass(59s);
    EXPECT_EQ(with(cookie, "GET", "/api/boards")->status(), 200);
    pass(1s);
    EXPECT_EQ(with(cookie, "GET", "/api/boards")->status(), 401);
    EXPECT_EQ(as("teach", "GET", "/api/lessons")->body()["items"].size(), 0u);
}

class LessonsOnThisMachine : public LessonsApi {
  protected:
    LessonsOnThisMachine() : LessonsApi(Role::kAdmin) {}
};

// Otherwise the browser of a pupil on the teacher's machine would be an admin once the lesson is over.
TEST_F(LessonsOnThisMachine, CookieOfALessonThatIsOver_GivesNoRightsOfTheMachine) {
    lesson_ = open();
    const auto cookie = pupil();
    as("teach", "DELETE", path());
    for (const auto& each : {cookie, std::string("asip=lesson.of-another-start")}) {
        EXPECT_EQ(with(each, "GET", "/api/boards")->status(), 401) << each;
        EXPECT_EQ(with(each, "POST", "/api/stop", "{}")->status(), 401) << each;
        EXPECT_EQ(with(each, "GET", "/")->status(), 200) << "the page says so";
        EXPECT_THAT(with(each, "GET", "/api/status")->detail(), HasSubstr("the gateway was started anew"));
    }
    const auto left = with(cookie, "DELETE", "/api/session");
    EXPECT_EQ(left->status(), 204);
    EXPECT_THAT(left->header("Set-Cookie"), HasSubstr("asip=; Max-Age=0"));
}

}  // namespace
}  // namespace asip::gateway
