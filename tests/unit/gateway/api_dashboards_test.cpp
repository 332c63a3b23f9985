// SPDX-License-Identifier: Apache-2.0
// Dashboards over HTTP: editors that do not overwrite each other, and links that show one dashboard and
// nothing else.
#include "api_bench.hpp"
#include "gateway/api/routes.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kLab = R"({"title":"Lab","widgets":[
  {"id":"far","kind":"value","board":"uno1","property":"distance/0"},
  {"id":"turn","kind":"slider","board":"uno1","property":"servo/0/angle"},
  {"id":"halt","kind":"stop"}]})";

class Dashboards_ : public ApiTest {
  protected:
    using ApiTest::ApiTest;
    using Headers = std::vector<std::pair<std::string, std::string>>;

    /// What was published as retained is sent back, as a broker does.
    void echo() {
        for (const auto& message : std::vector<mqtt::Message>(published_))
            if (message.topic.starts_with("asip/export/dashboard/")) gateway_->message(message);
        std::erase_if(published_,
                      [](const auto& each) { return each.topic.starts_with("asip/export/dashboard/"); });
    }
    std::shared_ptr<Captured> put(const std::string& name, const std::string& body, Headers headers = {}) {
        headers.emplace_back("content-type", "application/json");
        auto answer = ask("PUT", "/api/dashboards/" + name, body, std::move(headers));
        echo();
        return answer;
    }
    std::string link(const std::string& body) {
        const auto made = ask("POST", "/api/dashboards/lab/links", body);
        echo();
        EXPECT_EQ(made->status(), 201) << made->detail();
        return made->body().value("token", "");
    }
    int seq_ = 0;

    /// As the agent of uno1 says them.
    void values(int seq, const std::string& by_id) {
        bus("asip/uno1/$values", R"({"version":1,"board":"uno1","session":"s1","seq":)" +
                                     std::to_string(seq) + R"(,"values":)" + by_id + "}");
    }
    /// The events of a stream that is subscribed to by a link.
    std::vector<json> told(Captured& socket) {
        std::vector<json> events;
        std::string message;
        while (socket.channel->take(message)) {
            auto event = json::parse(message);
            message.clear();
            if (event.contains("event") || event.contains("error")) events.push_back(std::move(event));
        }
        return events;
    }
    std::shared_ptr<Captured> socket(const std::string& prefix) {
        return ask("GET", prefix + "/api/stream", {},
                   {{"upgrade", "websocket"},
                    {"connection", "upgrade"},
                    {"sec-websocket-version", "13"},
                    {"sec-websocket-key", "dGhlIHNhbXBsZSBub25jZQ=="}});
    }
    static std::vector<std::string> kinds(const std::vector<json>& events) {
        std::vector<std::string> result;
        for (const auto& event : events)
            result.push_back(event.value("event", event.contains("error") ? "error" : "?"));
        return result;
    }
};

TEST_F(Dashboards_, TwoEditors_DoNotOverwriteEachOther) {
    const auto made = put("lab", kLab);
    ASSERT_EQ(made->status(), 201) << made->detail();
    const auto first = made->header("ETag");
    EXPECT_EQ(get("/api/dashboards/lab")->header("ETag"), first);
    EXPECT_EQ(put("lab", kLab)->status(), 428);
    EXPECT_EQ(put("lab", kLab, {{"if-none-match", "*"}})->status(), 412);
    const auto changed = put("lab", R"({"title":"Hall","widgets":[]})", {{"if-match", first}});
    EXPECT_EQ(changed->status(), 200);
    const auto late = put("lab", kLab, {{"if-match", first}});
    EXPECT_EQ(late->status(), 412);
    EXPECT_THAT(late->detail(), HasSubstr("was changed meanwhile by loopback; read it again"));
    EXPECT_EQ(get("/api/dashboards/lab")->body()["title"], "Hall");
    EXPECT_EQ(put("lab", kLab, {{"if-match", "*"}})->status(), 200);
    EXPECT_EQ(ask("DELETE", "/api/dashboards/lab", {}, {{"if-match", first + "x"}})->status(), 0)
        << "that of Lab";
    echo();
    EXPECT_EQ(get("/api/dashboards/lab")->status(), 404);
    EXPECT_EQ(put("lab", kLab, {{"if-match", first}})->status(), 412) << "it was removed meanwhile";
    EXPECT_EQ(get("/api/dashboards")->body()["items"], json::array());
}

TEST_F(Dashboards_, WriteUnderWay_AnotherOneWaits) {
    const Headers json_type{{"content-type", "application/json"}};
    const auto one = ask("PUT", "/api/dashboards/lab", kLab, json_type);
    EXPECT_EQ(one->status(), 0) << "the broker has not got it yet";
    EXPECT_EQ(ask("PUT", "/api/dashboards/lab", kLab, json_type)->status(), 409);
    pass(6s);
    EXPECT_EQ(one->status(), 503);
    EXPECT_THAT(one->detail(), HasSubstr("the broker did not keep it"));
    published_.clear();
    EXPECT_EQ(put("lab", kLab)->status(), 201);
    const auto removal = ask("DELETE", "/api/dashboards/lab");
    EXPECT_EQ(ask("DELETE", "/api/dashboards/lab")->status(), 409);
    EXPECT_EQ(ask("POST", "/api/dashboards/lab/links", "{}")->status(), 409);
    EXPECT_EQ(ask("DELETE", "/api/dashboards/lab/links/x")->status(), 409);
    echo();
    EXPECT_EQ(removal->status(), 204);
    EXPECT_EQ(put("set", kLab)->status(), 400);
    for (int i = 0; i < 64; ++i)
        put("d" + std::to_string(i), R"({"widgets":[]})");
    EXPECT_EQ(put("more", kLab)->status(), 409);
    EXPECT_THAT(put("more", kLab)->detail(), HasSubstr("remove one first"));
}

TEST_F(Dashboards_, WidgetsOfABoard_SetItsProperties) {
    announce();
    put("lab", kLab);
    const auto turn = ask("POST", "/api/dashboards/lab/widgets/turn", R"({"value":90})");
    ASSERT_EQ(published_.size(), 1u);
    EXPECT_EQ(published_[0].topic, "asip/uno1/servo/in");
    EXPECT_EQ(json::parse(published_[0].payload)["write"], json::parse("[0,90]"));
    answer(R"({"status":"ok","proof":"fence"})");
    EXPECT_EQ(turn->status(), 204);
    EXPECT_THAT(ask("POST", "/api/dashboards/lab/widgets/turn", R"({"value":181})")->detail(),
                HasSubstr("cannot be set to 181"));
    EXPECT_EQ(ask("POST", "/api/dashboards/lab/widgets/turn", R"({"value":1,"x":1})")->status(), 400);
    EXPECT_EQ(ask("POST", "/api/dashboards/lab/widgets/far", R"({"value":1})")->status(), 400);
    EXPECT_EQ(ask("POST", "/api/dashboards/lab/widgets/none", R"({"value":1})")->status(), 404);
    published_.clear();
    ask("POST", "/api/dashboards/lab/widgets/halt", "{}");
    ASSERT_EQ(published_.size(), 1u);
    EXPECT_EQ(published_[0].topic, "asip/uno1/$stop");
    EXPECT_THAT(published_[0].payload, HasSubstr("\"latch\":true"));
    bus("asip/servicebus/uno1/$state", "lost");
    EXPECT_EQ(ask("POST", "/api/dashboards/lab/widgets/turn", R"({"value":90})")->status(), 503);
}

TEST_F(Dashboards_, Link_ShowsItsDashboardAndNothingElse) {
    announce();
    announce("uno2");
    bus("asip/uno2/distance/out", R"({"distance":[7]})");
    put("lab", kLab);
    put("other", R"({"widgets":[]})");
    for (const bool control : {false, true}) {
        const auto token = link(control ? R"({"control":true})" : "{}");
        const Headers bearer{{"authorization", "Bearer " + token}};
        for (const auto& route : api::routes()) {
            std::string path(route.path);
            for (const auto& [level, name] : {std::pair{"{board}", "uno1"},
                                              {"{service}", "distance"},
                                              {"{command}", "measure"},
                                              {"{id}", "uno1"},
                                              {"{name}", "distance"},
                                              {"{property}", "distance-0"},
                                              {"{action}", "none"},
                                              {"{type}", "thing_created"},
                                              {"{dashboard}", "other"},
                                              {"{widget}", "halt"},
                                              {"{link}", "none"}}) {
                if (const auto at = path.find(level); at != std::string::npos)
                    path.replace(at, std::string_view(level).size(), name);
            }
            auto headers = bearer;
            if (route.method == "PUT") headers.emplace_back("content-type", "application/json");
            const auto by_token = ask(std::string(route.method), path, "{}", headers);
            const auto by_link = ask(std::string(route.method), "/kiosk/" + token + path, "{}");
            const bool open =
                route.need == api::Need::kNothing || path == "/api/status" || path == "/api/stream";
            if (open) continue;
            EXPECT_EQ(by_token->status(), 403)
                << route.method << " " << path << " " << by_token->response->text();
            EXPECT_EQ(by_link->status(), 403)
                << route.method << " " << path << " " << by_link->response->text();
            EXPECT_THAT(std::string(by_token->response->text()), testing::Not(HasSubstr("uno2")));
        }
        const auto shown = get("/kiosk/" + token + "/api/dashboards/lab");
        EXPECT_EQ(shown->body()["title"], "Lab");
        EXPECT_FALSE(shown->body().contains("links"));
        EXPECT_FALSE(shown->body().contains("by"));
        const auto status = get("/kiosk/" + token + "/api/status")->body();
        EXPECT_EQ(status["you"]["dashboard"], "lab");
        EXPECT_EQ(status["you"]["control"], control);
        EXPECT_EQ(status["mirror"]["boards"], 0);
        EXPECT_FALSE(status.contains("registries"));
        published_.clear();
        const auto turn =
            ask("POST", "/kiosk/" + token + "/api/dashboards/lab/widgets/turn", R"({"value":9})");
        EXPECT_EQ(turn->status(), control ? 0 : 403);
        EXPECT_EQ(published_.size(), control ? 1u : 0u);
    }
}

TEST_F(Dashboards_, StreamOfALink_HasTheValuesOfItsWidgetsAndNothingElse) {
    announce();
    announce("uno2");
    put("lab", kLab);
    const auto open = socket("/kiosk/" + link("{}"));
    ASSERT_EQ(open->status(), 101);
    for (const auto* request :
         {R"({"subscribe":"$catalogue","ref":1})", R"({"subscribe":"*/*","ref":2})",
          R"({"subscribe":"uno1/distance","ref":3})", R"({"subscribe":"$dashboard","name":"other","ref":4})",
          R"({"command":"uno1/servo","write":[0,90],"id":"1"})"})
        open->channel->received(request);
    for (const auto& event : told(*open))
        EXPECT_TRUE(event.contains("error")) << event;
    EXPECT_TRUE(published_.empty());
    values(1, R"({"servo/0/angle":{"value":90,"how":"set","age":0},)"
              R"("servo/1/angle":{"value":45,"how":"set","age":0}})");
    open->channel->received(R"({"subscribe":"$dashboard","name":"lab","ref":5})");
    auto events = told(*open);
    EXPECT_THAT(kinds(events), ElementsAre("dashboard", "board", "property", "property", "widget", "widget",
                                           "snapshot-end"));
    EXPECT_FALSE(events[0]["dashboard"].contains("by")) << events[0];
    EXPECT_EQ(events[1]["state"], "online");
    EXPECT_EQ(events[3]["property"]["max"], 180);
    EXPECT_EQ(events[4]["value"], nullptr);
    EXPECT_EQ(events[5]["value"], 90);
    bus("asip/uno1/distance/out", R"({"distance":[42,118]})");
    bus("asip/uno2/distance/out", R"({"distance":[7]})");
    bus("asip/uno1/distance/error", R"({"code":7})");
    values(2, R"({"servo/0/angle":{"unknown":"doubt","age":0},)"
              R"("servo/1/angle":{"value":50,"how":"set","age":0}})");
    time_ += 1s;
    events = told(*open);
    ASSERT_EQ(events.size(), 2u);
    EXPECT_EQ(events[0]["value"], 42);
    EXPECT_FALSE(json(events).dump().find("118") != std::string::npos) << events[0];
    EXPECT_EQ(events[1]["value"], nullptr) << "servo 0 is not known any more";
    bus("asip/servicebus/uno1/$state", "lost");
    bus("asip/servicebus/uno2/$state", "lost");
    pass(100ms);
    events = told(*open);
    ASSERT_EQ(events.size(), 1u);
    EXPECT_EQ(events[0]["state"], "lost");
}

TEST_F(Dashboards_, EditOfADashboard_ChangesWhatItsLinkShows) {
    announce();
    put("lab", kLab);
    const auto token = link(R"({"control":true,"name":"hall"})");
    const auto open = socket("/kiosk/" + token);
    open->channel->received(R"({"subscribe":"$dashboard","name":"lab","ref":5})");
    told(*open);
    put("lab", R"({"title":"Lab","widgets":[{"id":"halt","kind":"stop"}]})", {{"if-match", "*"}});
    pass(100ms);
    EXPECT_THAT(kinds(told(*open)), ElementsAre("dashboard", "snapshot-end"));
    bus("asip/uno1/distance/out", R"({"distance":[42]})");
    pass(1s);
    EXPECT_TRUE(told(*open).empty());
    EXPECT_EQ(ask("POST", "/kiosk/" + token + "/api/dashboards/lab/widgets/turn", R"({"value":9})")->status(),
              404);
    ask("DELETE", "/api/dashboards/lab/links/hall");
    echo();
    pass(1s);
    EXPECT_EQ(open->channel->close_code(), 1008) << "its link was ended";
    EXPECT_EQ(get("/kiosk/" + token + "/api/status")->status(), 404);
}

TEST_F(Dashboards_, WidgetOfLabels_IsOneOfEachBoardThatHasThemNow) {
    const auto pupil = [this](const std::string& board, const std::string& room) {
        bus("asip/servicebus/" + board + "/$description",
            R"({"board":")" + board + R"(","session":"s1","seq":)" + std::to_string(++seq_) +
                R"(,"lease":60,"labels":{"class":")" + room +
                R"("},"services":[{"name":"servo","id":"S","model":"servo@1"}]})");
        bus("asip/servicebus/" + board + "/$state", "online");
    };
    pupil("ann", "4b");
    pupil("bob", "4b");
    pupil("cid", "5a");
    put("lab",
        R"({"title":"Lab","widgets":[{"id":"turn","kind":"slider","labels":"class=4b","property":"servo/0/angle"},
        {"id":"halt","kind":"stop"}]})");
    const auto token = link(R"({"control":true})");
    const auto open = socket("/kiosk/" + token);
    open->channel->received(R"({"subscribe":"$dashboard","name":"lab","ref":5})");
    const auto tiles = [this, &open] {
        std::vector<std::string> ids;
        for (const auto& event : told(*open))
            if (event.value("event", "") == "dashboard")
                for (const auto& each : event["tiles"])
                    ids.push_back(each["id"]);
        return ids;
    };
    EXPECT_THAT(tiles(), ElementsAre("turn.ann", "turn.bob", "halt"));
    pass(2s);
    EXPECT_TRUE(tiles().empty()) << "nothing has changed";
    pupil("cid", "4b");
    pupil("ann", "5a");
    pass(2s);
    EXPECT_THAT(tiles(), ElementsAre("turn.bob", "turn.cid", "halt"));
    const auto use = [&](const std::string& id) {
        return ask("POST", "/kiosk/" + token + "/api/dashboards/lab/widgets/" + id, R"({"value":9})");
    };
    EXPECT_EQ(use("turn.ann")->status(), 404);
    EXPECT_EQ(use("turn")->status(), 404);
    published_.clear();
    use("turn.cid");
    ASSERT_EQ(published_.size(), 1u);
    EXPECT_EQ(published_[0].topic, "asip/cid/servo/in");
    EXPECT_EQ(get("/api/dashboards/lab")->body()["widgets"][0]["labels"], "class=4b");
}

TEST_F(Dashboards_, LinkMadeAnewUnderItsName_EndsTheStreamsOfTheOldOne) {
    put("lab", kLab);
    const auto token = link(R"({"control":true,"name":"hall"})");
    const auto open = socket("/kiosk/" + token);
    ask("DELETE", "/api/dashboards/lab/links/hall");
    echo();
    const auto again = link(R"({"control":true,"name":"hall"})");
    pass(1s);
    EXPECT_EQ(open->channel->close_code(), 1008);
    EXPECT_EQ(get("/kiosk/" + token + "/api/status")->status(), 404);
    EXPECT_EQ(get("/kiosk/" + again + "/api/status")->status(), 200);
}

/// An operator who left must not go on through a link.
TEST_F(Dashboards_, Link_EndsWithTheTokenOfItsMaker) {
    announce();
    const Headers anna{{"authorization", "Bearer do"}};
    const auto tokens = [this](const std::string& text) {
        gateway_->gate().set_tokens(*Tokens::parse(text));
    };
    const auto make = [&] {
        const auto made = ask("POST", "/api/dashboards/lab/links", R"({"control":true})", anna);
        echo();
        return made->body().value("token", "");
    };
    const auto by_anna = "operator anna " + hash_of("do");
    const auto again = "operator anna " + hash_of("do again");
    put("lab", kLab);
    for (const std::string& after : {std::string(), "viewer anna " + hash_of("do"), by_anna + " boards=uno1",
                                     by_anna + " until=1970-01-01T00:00:00.000Z", again}) {
        tokens(by_anna + "\n");
        const auto token = make();
        const auto open = socket("/kiosk/" + token);
        ASSERT_EQ(open->status(), 101);
        pass(1s);
        EXPECT_EQ(open->channel->close_code(), 0);
        tokens(after + "\n");
        EXPECT_EQ(
            ask("POST", "/kiosk/" + token + "/api/dashboards/lab/widgets/turn", R"({"value":9})")->status(),
            404)
            << after;
        pass(1s);
        EXPECT_EQ(open->channel->close_code(), 1008) << after;
    }
}

TEST_F(Dashboards_, Links_AreListedWithTheirMakers_AndEndAfterAMonthUnlessTheySayWhen) {
    put("lab", kLab);
    link(R"({"name":"hall"})");
    link(R"({"name":"year","until":"365d"})");
    const auto links = get("/api/dashboards")->body()["items"][0]["links"];
    ASSERT_EQ(links.size(), 2u);
    const auto days = [&](std::size_t i) {
        const auto until = text::parse_iso_time(links[i].value("until", ""));
        return until ? std::chrono::floor<std::chrono::days>(*until - gateway_->now().wall).count() : 0;
    };
    EXPECT_EQ(links[0]["by"], "loopback");
    EXPECT_EQ(days(0), 30);
    EXPECT_EQ(days(1), 365);
    const auto token = link("{}");
    EXPECT_FALSE(get("/kiosk/" + token + "/api/dashboards/lab")->body().contains("links"));
    const auto open = socket("/kiosk/" + token);
    pass(30 * 24h - 1s);
    EXPECT_EQ(get("/kiosk/" + token + "/api/dashboards/lab")->status(), 200);
    EXPECT_EQ(open->channel->close_code(), 0);
    pass(1s);
    EXPECT_EQ(get("/kiosk/" + token + "/api/dashboards/lab")->status(), 404);
    EXPECT_EQ(open->channel->close_code(), 1008);
}

TEST_F(Dashboards_, LinkWithoutAnEnd_LastsUntilItIsEnded) {
    put("lab", kLab);
    const auto token = link(R"({"name":"hall","until":null})");
    EXPECT_FALSE(get("/api/dashboards")->body()["items"][0]["links"][0].contains("until"));
    pass(10 * 365 * 24h);
    EXPECT_EQ(get("/kiosk/" + token + "/api/dashboards/lab")->status(), 200);
    ask("DELETE", "/api/dashboards/lab/links/hall");
    echo();
    EXPECT_EQ(get("/kiosk/" + token + "/api/dashboards/lab")->status(), 404);
}

TEST_F(Dashboards_, PastOfAPlot_IsAskedOfTheRegistry_AndALinkSeesAsMuchAsThePlot) {
    announce();
    bus("asip/registry/r1/$state", "online");
    const auto plot = [](const std::string& id, const std::string& more) {
        return R"({"kind":"plot","board":"uno1","property":"distance/0","id":")" + id + "\"" + more + "}";
    };
    put("lab", R"({"widgets":[)" + plot("week", R"(,"span":"week")") + "," + plot("now", "") +
                   R"(,{"id":"value","kind":"value","board":"uno1","property":"distance/0"}]})");
    const auto prefix = "/kiosk/" + link("{}");
    settle();
    published_.clear();
    const auto days_asked = [&](const std::string& target) {
        const auto answer = get(target);
        EXPECT_EQ(answer->status(), 0) << answer->detail();
        const auto query = json::parse(published_.back().payload);
        EXPECT_EQ(query["board"], "uno1");
        EXPECT_EQ(query["property"], "distance/0");
        const auto from = text::parse_iso_time(query["from"].get<std::string>());
        return std::chrono::round<std::chrono::days>(gateway_->now().wall - *from).count();
    };
    const auto month = "?points=100&from=" + text::iso_time(gateway_->now().wall - 31 * 24h);
    const std::string widgets = "/api/dashboards/lab/widgets/";
    EXPECT_EQ(days_asked(widgets + "week/kept" + month), 31);
    EXPECT_EQ(days_asked(widgets + "now/kept"), 1);
    EXPECT_EQ(days_asked(prefix + widgets + "week/kept" + month), 14) << "the week, and one before";
    EXPECT_EQ(get(prefix + widgets + "now/kept" + month)->status(), 403);
    EXPECT_EQ(get(widgets + "value/kept")->status(), 400);
    EXPECT_EQ(get(widgets + "week/kept?from=x")->status(), 400);
    EXPECT_EQ(get(widgets + "none/kept")->status(), 404);
}

TEST_F(Dashboards_, LinksWhoseTimeIsOver_TakeNoRoom) {
    put("lab", kLab);
    const auto make = [this] {
        const auto made = ask("POST", "/api/dashboards/lab/links", R"({"until":"1h"})");
        echo();
        return made->status();
    };
    for (std::size_t i = 0; i < Dashboard::kMaxLinks; ++i)
        link(R"({"until":"1h","name":"l)" + std::to_string(i) + "\"}");
    EXPECT_EQ(make(), 409);
    pass(3700s);
    EXPECT_EQ(make(), 201);
    EXPECT_EQ(get("/api/dashboards/lab")->body()["links"].size(), 1u);
}

/// A link that could say how often boards report would be one that does more than show.
TEST_F(Dashboards_, StreamOfALink_LetsBoardsReportNoOftenerThanADashboardNeeds) {
    time_ = 1000s;
    announce();
    bus("asip/servicebus/uno1/$description",
        R"({"board":"uno1","session":"s1","seq":2,"lease":60,"on_demand":{"fastest":20,"resting":0},)"
        R"("services":[{"name":"distance","id":"D","model":"distance@1"},{"name":"servo","id":"S"}]})");
    put("lab", kLab);
    const auto token = link("{}");
    const auto demanded = [this](const std::string& prefix) {
        const auto open = socket(prefix);
        published_.clear();
        open->channel->received(R"({"subscribe":"$dashboard","name":"lab","ref":5,"max_hz":1000})");
        pass(1s);
        pass(1s);
        std::string payloads;
        for (const auto& each : published_)
            if (each.topic.find("$demand") != std::string::npos) payloads += each.payload;
        return payloads;
    };
    EXPECT_THAT(demanded("/kiosk/" + token), HasSubstr(R"("distance":10.0)"));
    EXPECT_THAT(demanded(""), HasSubstr(R"("distance":1000.0)"));
}

TEST_F(Dashboards_, RemovedDashboard_EndsItsLinksAndSaysSoToOthers) {
    put("lab", kLab);
    const auto token = link(R"({"until":"1h"})");
    const auto kiosk = socket("/kiosk/" + token);
    const auto other = socket("");
    for (const auto& each : {kiosk, other}) {
        each->channel->received(R"({"subscribe":"$dashboard","name":"lab","ref":5})");
        told(*each);
    }
    ask("DELETE", "/api/dashboards/lab");
    echo();
    pass(1s);
    EXPECT_EQ(kiosk->channel->close_code(), 1008);
    EXPECT_THAT(kinds(told(*other)), ElementsAre("gone"));
    put("lab", kLab);
    pass(100ms);
    EXPECT_THAT(kinds(told(*other)), Contains("dashboard"));
    const auto again = link(R"({"until":"1h"})");
    EXPECT_EQ(get("/kiosk/" + token + "/api/status")->status(), 404)
        << "a link is of the one that was removed";
    EXPECT_EQ(get("/kiosk/" + again + "/api/status")->status(), 200);
    pass(3700s);
    EXPECT_EQ(get("/kiosk/" + again + "/api/status")->status(), 404) << "its time is over";
}

TEST_F(Dashboards_, TokenOfTheFile_EndsWithItsDashboard) {
    put("lab", kLab);
    gateway_->gate().set_tokens(*Tokens::parse(
        "kiosk hall " + hash_of("abc") + " dashboard=lab control=yes\n" + "operator ann " + hash_of("ann") +
        " boards=uno*\noperator bob " + hash_of("bob") + " services=distance,servo\n"));
    EXPECT_EQ(get("/kiosk/abc/api/dashboards/lab")->status(), 200);
    const Headers ann{{"authorization", "Bearer ann"}, {"content-type", "application/json"}};
    EXPECT_EQ(ask("GET", "/api/dashboards/lab", {}, ann)->status(), 200) << "it sees all boards of it";
    EXPECT_EQ(ask("PUT", "/api/dashboards/lab", kLab, ann)->status(), 403);
    const Headers bob{{"authorization", "Bearer bob"}, {"content-type", "application/json"}};
    EXPECT_EQ(ask("GET", "/api/dashboards/lab", {}, bob)->status(), 200);
    EXPECT_EQ(ask("POST", "/api/dashboards/lab/widgets/halt", "{}", bob)->status(), 403)
        << "it may stop nothing";
    put("lab", R"({"widgets":[{"kind":"value","board":"mega","property":"a/b"}]})", {{"if-match", "*"}});
    EXPECT_EQ(ask("GET", "/api/dashboards/lab", {}, ann)->status(), 404);
    EXPECT_EQ(ask("GET", "/api/dashboards", {}, ann)->body()["items"], json::array());
    ask("DELETE", "/api/dashboards/lab");
    echo();
    EXPECT_EQ(get("/kiosk/abc/api/dashboards/lab")->status(), 404);
}

/// Whatever is not known yet may be there.
TEST_F(Dashboards_, BeforeTheBrokerWasRead_NothingIsSaidToBeMissing) {
    GatewayOptions options;
    options.gate.hosts = {"localhost"};
    options.gate.loopback.role = Role::kAdmin;
    Gateway::Port port;
    port.now = [this] { return at(time_); };
    port.publish = [](mqtt::Message) { return true; };
    port.calls.subscribe = [](const std::string&, mqtt::SubscribeOptions) {};
    port.soon = [](const std::function<void()>& then) { then(); };
    gateway_ = std::make_unique<Gateway>(
        std::move(options), model::ModelSet::standard(), catalogue::UnitsOf(),
        [n = 0ull]() mutable { return ++n << 56; }, [](std::size_t) { return std::string("secret"); },
        std::move(port));
    EXPECT_EQ(get("/api/dashboards/lab")->status(), 503);
    EXPECT_EQ(get("/kiosk/abc/api/status")->status(), 503);
}

}  // namespace
}  // namespace asip::gateway
