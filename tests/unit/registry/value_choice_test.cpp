// SPDX-License-Identifier: Apache-2.0
// Which properties are kept, and what is demanded of their boards.
#include "registry/values/value_choice.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace asip::registry {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

struct Chosen {
    explicit Chosen(ValueChoice::Options options = {}) {
        Port port;
        port.publish = [this](mqtt::Message message) { published.push_back(std::move(message)); };
        port.subscribe = [this](const std::string& filter, bool) { subscribed.insert(filter); };
        port.unsubscribe = [this](const std::string& filter) { subscribed.erase(filter); };
        ValueChoice::Handlers handlers;
        handlers.set = [this](const PropertyKey& key, double value) { values[key] = value; };
        handlers.drop = [this](const PropertyKey& key) { values.erase(key); };
        handlers.look = [this](const std::string& board) -> std::optional<bus::BoardItem> {
            const auto found = boards.find(board);
            return found == boards.end() ? std::nullopt : std::optional(found->second);
        };
        const auto random = [] { return std::uint64_t{1}; };
        choice.emplace(topics, std::move(options), port, bus::Demander(topics, "registry", "r", random),
                       handlers);
        choice->connected(now);
    }
    bus::BoardItem& board(const std::string& name) {
        auto& item = boards[name];
        item.board = name;
        item.state = "online";
        item.session = "a";
        return item;
    }
    void look(const std::string& name) {
        choice->changed(name);
        tick();
    }
    void tick() {
        now += seconds(5);
        choice->tick(now);
    }
    void describe(const std::string& name) {
        mqtt::Message message;
        message.topic = topics.description(name);
        message.payload =
            R"({"board":")" + name +
            R"(","session":"a","seq":1,"lease":60,"on_demand":{"fastest":20,"resting":0},"services":[]})";
        choice->description(message, now);
    }
    /// {"io/2":true}; a null is not known.
    void say(const std::string& name, const nlohmann::json& all, const std::string& session = "a") {
        nlohmann::json document{{"version", 1}, {"board", name}, {"session", session}, {"seq", ++seq}};
        document["values"] = nlohmann::json::object();
        for (const auto& [id, value] : all.items())
            document["values"][id] = value.is_null()
                                         ? nlohmann::json{{"unknown", "restart"}, {"age", 0}}
                                         : nlohmann::json{{"value", value}, {"how", "reported"}, {"age", 0}};
        choice->values(name, document.dump());
    }
    void dashboard(const std::string& name, const std::string& payload) {
        mqtt::Message message;
        message.topic = "asip/export/dashboard/" + name;
        message.payload = payload;
        ASSERT_TRUE(choice->dashboard(message, [this] {
            std::vector<std::string> names;
            for (const auto& [board, item] : boards)
                names.push_back(board);
            return names;
        }));
        tick();
    }
    bool keeps(const std::string& name, const std::string& id) const { return values.contains({name, id}); }

    bus::Topics topics{"asip"};
    std::map<std::string, bus::BoardItem> boards;
    std::map<PropertyKey, double> values;
    std::set<std::string> subscribed;
    std::vector<mqtt::Message> published;
    std::optional<ValueChoice> choice;
    Time now{seconds(100)};
    int seq = 0;
};

const nlohmann::json kAll{{"io/2", true},
                          {"io/3", false},
                          {"distance/0", 42},
                          {"lcd/text", "hello"},
                          {"pixels/0", {{"on", true}, {"brightness", 128}}}};

TEST(ValueChoice, NothingNamed_NothingIsReadOrKept) {
    Chosen chosen;
    chosen.board("desk");
    chosen.look("desk");
    chosen.say("desk", kAll);
    EXPECT_TRUE(chosen.subscribed.empty());
    EXPECT_TRUE(chosen.values.empty());
}

TEST(ValueChoice, NamedPinAndService_AreKeptAsNumbers_UntilTheNameGoes) {
    Chosen chosen;
    chosen.board("desk").labels.pins[2] = "door";
    chosen.board("desk").labels.services = {{"pixels", "strip"}, {"lcd", "text"}};
    chosen.look("desk");
    EXPECT_EQ(chosen.subscribed, (std::set<std::string>{"asip/desk/$values"}));
    chosen.say("desk", kAll);
    EXPECT_EQ(chosen.values,
              (std::map<PropertyKey, double>{{{"desk", "io/2"}, 1}, {{"desk", "pixels/0"}, 128}}));
    chosen.board("desk").labels = {};
    chosen.look("desk");
    EXPECT_TRUE(chosen.values.empty());
    EXPECT_TRUE(chosen.subscribed.empty());
}

TEST(ValueChoice, PatternsAndDashboards_ChooseByBoardLabelAndProperty) {
    Chosen chosen({.patterns = {"d*/distance*"}, .demand_hz = 0});
    chosen.board("desk").labels.labels["room"] = "lab";
    chosen.look("desk");
    chosen.say("desk", kAll);
    EXPECT_TRUE(chosen.keeps("desk", "distance/0"));
    EXPECT_FALSE(chosen.keeps("desk", "io/3"));
    chosen.dashboard(
        "one",
        R"({"widgets":[{"board":"desk","property":"io/3"},{"labels":"room=lab","property":"io/2"},7]})");
    EXPECT_TRUE(chosen.keeps("desk", "io/3"));
    EXPECT_TRUE(chosen.keeps("desk", "io/2"));
    for (const char* payload : {R"({"removed":true})", "", "{", "[]"}) {
        chosen.dashboard("one", payload);
        EXPECT_FALSE(chosen.keeps("desk", "io/3")) << payload;
    }
    EXPECT_TRUE(chosen.keeps("desk", "distance/0"));
}

TEST(ValueChoice, DashboardIsRemovedWhileTheConnectionIsBroken_NoLongerChooses) {
    Chosen chosen;
    chosen.board("desk");
    chosen.dashboard("gone", R"({"widgets":[{"board":"desk","property":"io/3"}]})");
    chosen.dashboard("stays", R"({"widgets":[{"board":"desk","property":"io/2"}]})");
    chosen.say("desk", kAll);
    EXPECT_TRUE(chosen.keeps("desk", "io/2") && chosen.keeps("desk", "io/3"));
    chosen.choice->disconnected();
    chosen.choice->connected(chosen.now);
    chosen.dashboard("stays", R"({"widgets":[{"board":"desk","property":"io/2"}]})");
    EXPECT_TRUE(chosen.keeps("desk", "io/3")) << "the other one may still come";
    chosen.choice->complete([] { return std::vector<std::string>{"desk"}; });
    chosen.tick();
    EXPECT_TRUE(chosen.keeps("desk", "io/2"));
    EXPECT_FALSE(chosen.keeps("desk", "io/3"));
}

TEST(ValueChoice, PropertiesThatAreSaidNoLonger_Leave_NewOnesHaveRoom) {
    Chosen chosen({.patterns = {"*/*"}, .demand_hz = 0});
    chosen.board("desk");
    chosen.look("desk");
    for (int board = 0; board < 4; ++board) {
        nlohmann::json all;
        for (int i = 0; i < 200; ++i)
            all["x" + std::to_string(board) + "/" + std::to_string(i)] = i;
        chosen.say("desk", all);
        EXPECT_EQ(chosen.values.size(), 200u) << board;
        EXPECT_TRUE(chosen.keeps("desk", "x" + std::to_string(board) + "/199")) << board;
    }
    chosen.choice->values("desk", "");
    EXPECT_TRUE(chosen.values.empty());
}

TEST(ValueChoice, BoardIsLost_RestartsOrHasAnotherAgent_Gap) {
    Chosen chosen({.patterns = {"*/*"}, .demand_hz = 0});
    chosen.board("desk");
    chosen.look("desk");
    chosen.say("desk", kAll);
    const PropertyKey key{"desk", "distance/0"};
    EXPECT_EQ(chosen.values[key], 42);
    chosen.board("desk").state = "lost";
    chosen.look("desk");
    EXPECT_TRUE(std::isnan(chosen.values[key]));
    chosen.board("desk").state = "online";
    chosen.boards["desk"].session = "b";  // what was said is of the agent before
    chosen.look("desk");
    EXPECT_TRUE(std::isnan(chosen.values[key]));
    chosen.say("desk", {{"distance/0", 43}}, "b");
    EXPECT_EQ(chosen.values[key], 43);
    chosen.say("desk", {{"distance/0", nullptr}}, "b");
    EXPECT_TRUE(std::isnan(chosen.values[key]));
    chosen.choice->values("desk", "{");
    chosen.say("desk", {{"distance/0", 44}}, "b");
    EXPECT_EQ(chosen.values[key], 44);
    chosen.choice->disconnected();
    EXPECT_EQ(chosen.values[key], 44) << "values come another way";
    chosen.choice->values_lost();
    EXPECT_TRUE(std::isnan(chosen.values[key]));
    chosen.choice->connected(chosen.now);
    chosen.say("desk", {{"distance/0", 44}}, "b");
    EXPECT_EQ(chosen.values[key], 44);
    chosen.boards.clear();
    chosen.look("desk");
    EXPECT_TRUE(chosen.values.empty());
}

TEST(ValueChoice, ByDefault_NothingIsSentToABoard) {
    Chosen chosen({.patterns = {"*/*"}, .demand_hz = 0});
    chosen.board("desk");
    chosen.describe("desk");
    chosen.look("desk");
    chosen.say("desk", kAll);
    for (int i = 0; i < 20; ++i)
        chosen.tick();
    EXPECT_TRUE(chosen.published.empty());
}

TEST(ValueChoice, DemandWanted_OnceASecondOfWhatIsKept_EndsWithTheChoice) {
    Chosen chosen({.patterns = {}, .demand_hz = 1});
    chosen.board("desk").labels.services["distance"] = "front";
    chosen.describe("desk");
    chosen.look("desk");
    chosen.say("desk", {{"distance/0", nullptr}, {"io/2", true}});  // it rests
    chosen.tick();
    ASSERT_FALSE(chosen.published.empty());
    EXPECT_EQ(nlohmann::json::parse(chosen.published.back().payload)["services"],
              nlohmann::json({{"distance", 1}}));
    chosen.board("desk").labels = {};
    chosen.look("desk");
    chosen.tick();
    EXPECT_EQ(nlohmann::json::parse(chosen.published.back().payload)["services"], nlohmann::json::object());
}

}  // namespace
}  // namespace asip::registry
