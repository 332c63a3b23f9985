// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/web_of_things.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "export_world.hpp"

namespace asip::gateway::exports {
namespace {

using nlohmann::json;

ExportedBoard desk() {
    auto board = exported(1);
    board.board = "uno1";
    board.properties.push_back(strip_of_pixels());
    board.properties.push_back(stop_button());
    return board;
}

WebOfThings::Forms forms(const std::string& broker = {}) {
    WebOfThings::Forms result;
    result.base = "http://pi:8080/";
    result.broker = broker;
    return result;
}

std::vector<std::string> addresses(const json& affordance, const std::string& operation) {
    std::vector<std::string> result;
    for (const auto& form : affordance["forms"])
        if (form["op"] == operation ||
            (form["op"].is_array() && std::count(form["op"].begin(), form["op"].end(), operation) > 0))
            result.push_back(form["href"]);
    return result;
}

TEST(Thing, HasAPropertyForEachEntity_AndAnActionForEachButton) {
    const auto thing = WebOfThings({}).thing(desk(), forms());
    EXPECT_EQ(thing["id"], "urn:asip:asip:uno1");
    EXPECT_EQ(thing["title"], "Desk");
    EXPECT_EQ(thing["security"], json::array({"http"}));
    EXPECT_EQ(thing["securityDefinitions"], json::parse(R"({"http":{"scheme":"nosec"}})"));
    std::vector<std::string> names;
    for (const auto& [name, property] : thing["properties"].items())
        names.push_back(name);
    EXPECT_THAT(names, testing::ElementsAre("board-state", "distance-0", "pixels-light", "servo-0-angle"));
    const auto& servo = thing["properties"]["servo-0-angle"];
    EXPECT_EQ(servo["type"], "integer");
    EXPECT_EQ(servo["maximum"], 180);
    EXPECT_EQ(servo["readOnly"], false);
    EXPECT_EQ(addresses(servo, "writeproperty"),
              std::vector<std::string>{"things/uno1/properties/servo-0-angle"});
    EXPECT_EQ(thing["properties"]["distance-0"]["readOnly"], true);
    EXPECT_TRUE(addresses(thing["properties"]["distance-0"], "writeproperty").empty());
    EXPECT_EQ(thing["properties"]["pixels-light"]["required"], json::array({"on"}));
    EXPECT_EQ(addresses(thing["actions"]["motors-stop"], "invokeaction"),
              std::vector<std::string>{"things/uno1/actions/motors-stop"});
    EXPECT_FALSE(thing.contains("events"));
}

TEST(Thing, WithABroker_TheTopicStandsInTheAddress) {
    const auto thing = WebOfThings({}).thing(desk(), forms("mqtt://pi:1883"));
    const auto& servo = thing["properties"]["servo-0-angle"];
    EXPECT_THAT(addresses(servo, "readproperty"),
                testing::Contains("mqtt://pi:1883/asip/export/wot/uno1/servo-0-angle"));
    EXPECT_THAT(addresses(servo, "writeproperty"),
                testing::Contains("mqtt://pi:1883/asip/export/wot/uno1/servo-0-angle/set"));
    EXPECT_EQ(addresses(thing["events"]["command-failed"], "subscribeevent"),
              std::vector<std::string>{"mqtt://pi:1883/asip/export/wot/uno1/$failed"});
    EXPECT_EQ(addresses(thing["properties"]["gateway-state"], "observeproperty"),
              std::vector<std::string>{"mqtt://pi:1883/asip/export/wot/$state"});
    EXPECT_EQ(thing["securityDefinitions"]["broker"]["scheme"], "nosec");
}

TEST(Thing, ForWhoMaySetNothing_IsReadOnly) {
    auto limited = forms("mqtt://pi:1883");
    limited.may_set = false;
    limited.token = limited.broker_password = true;
    WebOfThings::Options options;
    options.read_only = true;
    const auto thing = WebOfThings(options).thing(desk(), limited);
    for (const auto& [name, property] : thing["properties"].items()) {
        EXPECT_EQ(property["readOnly"], true) << name;
        EXPECT_TRUE(addresses(property, "writeproperty").empty()) << name;
    }
    EXPECT_FALSE(thing.contains("actions"));
    EXPECT_EQ(thing["securityDefinitions"]["http"]["scheme"], "bearer");
    EXPECT_EQ(thing["securityDefinitions"]["broker"]["scheme"], "basic");
}

TEST(Thing, IsFoundByItsIdOrTheNameOfItsBoard) {
    WebOfThings::Options options;
    options.root = "my lab/one";
    const WebOfThings dialect(options);
    EXPECT_EQ(dialect.thing_id("uno1"), "urn:asip:my%20lab%2Fone:uno1");
    EXPECT_EQ(dialect.board_of("urn:asip:my%20lab%2Fone:uno1"), "uno1");
    EXPECT_EQ(dialect.board_of("uno1"), "uno1");
    EXPECT_EQ(dialect.board_of("urn:asip:other:uno1"), "urn:asip:other:uno1");
}

TEST(Thing, Directory_NamesListThingsAndEvents) {
    const auto directory = WebOfThings({}).directory(forms("mqtt://pi:1883"));
    EXPECT_EQ(directory["@type"], "ThingDirectory");
    EXPECT_EQ(directory["properties"]["things"]["forms"][0]["href"], "things{?offset,limit}");
    EXPECT_EQ(addresses(directory["events"]["thingDeleted"], "subscribeevent"),
              std::vector<std::string>{"events/thing_deleted"});
    EXPECT_FALSE(directory["securityDefinitions"].contains("broker"));
}

class ThingsOverMqtt : public testing::Test {
  protected:
    ExportWorld::Gateway& start() {
        world_.put("uno1", desk());
        auto& gateway = world_.start();
        world_.pass(5s);
        return gateway;
    }
    ExportWorld world_{1, std::make_shared<WebOfThings>(WebOfThings::Options{})};
};

TEST_F(ThingsOverMqtt, ValuesAreRetainedAsJson_WithTheStateOfTheBoard) {
    start();
    EXPECT_EQ(world_.retained["asip/export/wot/$state"], "\"online\"");
    EXPECT_EQ(world_.retained["asip/export/wot/uno1/$state"], "\"online\"");
    world_.value("uno1", "distance", R"({"distance":[42]})");
    world_.pass(1s);
    EXPECT_EQ(world_.retained["asip/export/wot/uno1/distance-0"], "42");
    world_.known("uno1", "servo/0/angle", 90);
    world_.pass(1s);
    EXPECT_EQ(world_.retained["asip/export/wot/uno1/servo-0-angle"], "90");
    world_.known("uno1", "servo/0/angle", std::nullopt);
    world_.pass(1s);
    EXPECT_FALSE(world_.retained.contains("asip/export/wot/uno1/servo-0-angle"))
        << "it is not known any more";
    world_.boards["uno1"].there = false;
    world_.changed("uno1");
    EXPECT_EQ(world_.retained["asip/export/wot/uno1/$state"], "\"lost\"");
    world_.forget("uno1");
    world_.pass(1s);
    for (const auto& [topic, payload] : world_.retained)
        EXPECT_EQ(topic.find("uno1"), std::string::npos) << topic;
}

TEST_F(ThingsOverMqtt, WhatIsWritten_IsACommand_AndStateFollowsItsProof) {
    auto& gateway = start();
    world_.publish("asip/export/wot/uno1/servo-0-angle/set", "90");
    world_.publish("asip/export/wot/uno1/motors-stop/set", "");
    world_.publish("asip/export/wot/uno1/pixels-light/set", R"({"on":true,"color":255})");
    world_.pass(1s);
    ASSERT_EQ(gateway.commands.size(), 4u);
    EXPECT_EQ(gateway.commands[0].second.payload, R"({"write":[0,90]})");
    EXPECT_EQ(gateway.commands[1].second.payload, R"({"stop":[]})");
    EXPECT_EQ(gateway.commands[2].second.payload, R"({"fill":[255]})");
    EXPECT_FALSE(world_.retained.contains("asip/export/wot/uno1/servo-0-angle"));
    gateway.answers[0]("INVALID_DEVICE_NUMBER");
    world_.pass(1s);
    EXPECT_EQ(world_.times_sent("asip/export/wot/uno1/$failed"), 1u);
    EXPECT_FALSE(world_.retained.contains("asip/export/wot/uno1/$failed"));
}

TEST_F(ThingsOverMqtt, WhatIsNoValue_IsRefusedInWords) {
    auto& gateway = start();
    const std::vector<std::string> wrong{"181",  "x",    "\"90\"", "",
                                         "null", "[90]", "1.5",    std::string(100000, '[')};
    for (const auto& payload : wrong)
        world_.publish("asip/export/wot/uno1/servo-0-angle/set", payload);
    world_.publish("asip/export/wot/uno1/distance-0/set", "1");
    world_.publish("asip/export/wot/uno1/none/set", "1");
    world_.publish("asip/export/wot/none/none/set", "1");
    world_.pass(1s);
    EXPECT_TRUE(gateway.commands.empty());
    EXPECT_EQ(world_.times_sent("asip/export/wot/uno1/$failed"), wrong.size() + 1);
}

}  // namespace
}  // namespace asip::gateway::exports
