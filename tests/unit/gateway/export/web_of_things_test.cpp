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

WebOfThings::Forms forms() {
    WebOfThings::Forms result;
    result.base = "http://pi:8080/";
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
    const auto thing = WebOfThings().thing(desk(), forms());
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

TEST(Thing, ForWhoMaySetNothing_IsReadOnly) {
    auto limited = forms();
    limited.may_set = false;
    limited.token = true;
    const auto thing = WebOfThings().thing(desk(), limited);
    for (const auto& [name, property] : thing["properties"].items()) {
        EXPECT_EQ(property["readOnly"], true) << name;
        EXPECT_TRUE(addresses(property, "writeproperty").empty()) << name;
    }
    EXPECT_FALSE(thing.contains("actions"));
    EXPECT_EQ(thing["securityDefinitions"]["http"]["scheme"], "bearer");
}

TEST(Thing, IsFoundByItsIdOrTheNameOfItsBoard) {
    const WebOfThings dialect("my lab/one");
    EXPECT_EQ(dialect.thing_id("uno1"), "urn:asip:my%20lab%2Fone:uno1");
    EXPECT_EQ(dialect.board_of("urn:asip:my%20lab%2Fone:uno1"), "uno1");
    EXPECT_EQ(dialect.board_of("uno1"), "uno1");
    EXPECT_EQ(dialect.board_of("urn:asip:other:uno1"), "urn:asip:other:uno1");
}

TEST(Thing, Directory_NamesListThingsAndEvents) {
    const auto directory = WebOfThings().directory(forms());
    EXPECT_EQ(directory["@type"], "ThingDirectory");
    EXPECT_EQ(directory["properties"]["things"]["forms"][0]["href"], "things{?offset,limit}");
    EXPECT_EQ(addresses(directory["events"]["thingDeleted"], "subscribeevent"),
              std::vector<std::string>{"events/thing_deleted"});
}

}  // namespace
}  // namespace asip::gateway::exports
