// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/home_assistant.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "asip/model/model_set.hpp"
#include "board_of_all.hpp"
#include "export_world.hpp"

namespace asip::gateway::exports {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// With a named pin.
model::Description named_description() {
    auto description = description_of_all();
    description.labels.pins[4] = "lamp";
    return description;
}

ExportedBoard board_of(const model::Description& description) {
    ExportedBoard board;
    board.board = "uno1";
    board.name = "Desk";
    board.chip = "ATmega328P";
    board.room = "lab";
    board.properties = property::properties_of(description, [](const model::ServiceInfo& service) {
        return model::ModelSet::standard().find(service.name);
    });
    return board;
}

ExportedBoard board_with_all() {
    return board_of(named_description());
}

json document_of(const HomeAssistant::Options& options = {}) {
    return json::parse(HomeAssistant(options).document(board_with_all()));
}

TEST(HomeAssistantDocument, Firmware_IsAnUpdateEntity_WhereTheBoardSaysItsVersion) {
    const HomeAssistant dialect{HomeAssistant::Options()};
    auto board = board_with_all();
    board.sketch = "AsipServices";
    const auto firmware = [&] { return json::parse(dialect.document(board))["cmps"]["firmware--update"]; };
    EXPECT_TRUE(firmware().is_null()) << "a sketch of ASIP 0.4";
    board.version = "0.2";
    EXPECT_EQ(firmware()["p"], "update");
    EXPECT_EQ(firmware()["stat_t"], dialect.firmware("uno1"));
    EXPECT_EQ(json::parse(dialect.firmware_text(board))["latest_version"], "0.2");
    board.available = "0.3";
    EXPECT_EQ(json::parse(dialect.firmware_text(board))["latest_version"], "0.3");
    board.version.clear();
    EXPECT_EQ(json::parse(dialect.firmware_text(board))["installed_version"], "0");
}

Property property_of(Kind kind) {
    Property property;
    property.id = "x";
    property.name = "X";
    property.kind = kind;
    property.service = "own";
    property.write = property::Call{"own", "set", {std::nullopt}};
    if (kind == Kind::kSwitch || kind == Kind::kSelect) property.choices = {{"off", 0}, {"on", 1}};
    property.min = 0;
    property.max = 100;
    if (kind == Kind::kText) property.max_length = 20;
    return property;
}

TEST(HomeAssistant, TextsOfOthers_AreEscapedInEachPlace) {
    HomeAssistant::Options options;
    options.root = R"(lab "1"\)";
    const HomeAssistant ha(options);
    auto board = board_with_all();
    board.name = "K\u00fcche \"A\\B\"\n";
    const auto document = json::parse(ha.document(board));
    EXPECT_EQ(document["avty"][0]["t"], ha.gateway_state());
    EXPECT_EQ(document["dev"]["name"], board.name);
    auto old = ha.components(board);
    old["a\"b"] = "sensor";
    EXPECT_EQ(json::parse(ha.removing_document(board, old))["cmps"]["a\"b"], (json{{"p", "sensor"}}));
}

TEST(HomeAssistantDocument, NamesBoardOriginAndAvailability) {
    const auto document = document_of();
    EXPECT_EQ(
        document["dev"],
        json::parse(R"({"ids":["asip-uno1"],"name":"Desk","mf":"ASIP","mdl":"ATmega328P","sa":"lab"})"));
    EXPECT_EQ(document["o"], json::parse(R"({"name":"asip-gateway"})"));
    EXPECT_EQ(document["avty"],
              json::parse(R"([{"t":"asip/export/ha/$state"},{"t":"asip/export/ha/uno1/$state"}])"));
    EXPECT_EQ(document["avty_mode"], "all");
}

TEST(HomeAssistantDocument, EachComponent_IsAsHomeAssistantTakesIt) {
    const auto document = document_of();
    std::set<std::string> unique;
    for (const auto& [id, component] : document["cmps"].items()) {
        SCOPED_TRACE(id + ": " + component.dump());
        EXPECT_TRUE(unique.insert(component["uniq_id"].get<std::string>()).second);
        EXPECT_EQ(component["uniq_id"], "asip-uno1_" + id);
        EXPECT_FALSE(component.contains("obj_id"));
        for (const auto& [key, value] : component.items())
            EXPECT_FALSE(value.is_null()) << key;
        const std::string kind = component["p"];
        if (kind != "button") {
            EXPECT_EQ(component["stat_t"], "asip/export/ha/uno1/" + id);
        }
        if (kind == "number") {
            EXPECT_LT(component["min"], component["max"]);
        }
        if (kind == "number") {
            EXPECT_GE(component["step"], 0.001);
        }
        if (component.contains("dev_cla") && component["dev_cla"] == "enum") {
            EXPECT_FALSE(component.contains("stat_cla"));
        }
        if (kind == "light") {
            EXPECT_EQ(component["sup_clrm"].size(), 1u);
        }
    }
    const auto& all = document["cmps"];
    EXPECT_EQ(all["distance-0"],
              json::parse(R"({"p":"sensor","uniq_id":"asip-uno1_distance-0","name":"Distance","stat_t":
                  "asip/export/ha/uno1/distance-0","unit_of_meas":"cm","dev_cla":"distance","stat_cla":"measurement"})"));
    EXPECT_EQ(all["pressure-temperature"]["unit_of_meas"],
              "\xc2\xb0"
              "C");
    EXPECT_FALSE(all["heading"].contains("stat_cla")) << "no class for angles before 2025";
    EXPECT_EQ(all["servo-0-angle"]["unit_of_meas"], "\xc2\xb0");
    EXPECT_EQ(all["servo-0-angle"]["cmd_t"], "asip/export/ha/uno1/servo-0-angle/set");
    EXPECT_EQ(all["io-4"]["p"], "switch");
    EXPECT_EQ(all["io-4"]["name"], "lamp");
    EXPECT_FALSE(all["io-4"].contains("en"));
    EXPECT_EQ(all["io-2"]["en"], false);
    EXPECT_EQ(all["last-error"]["ent_cat"], "diagnostic");
}

model::Meaning of_class(const std::string& klass) {
    model::Meaning meaning;
    meaning.klass = klass;
    return meaning;
}

/// The component of pin 13 with this meaning.
json pin_13(const model::Meaning& meaning) {
    auto description = named_description();
    description.labels.meanings["io/13"] = meaning;
    return json::parse(HomeAssistant({}).document(board_of(description)))["cmps"]["io-13"];
}

TEST(HomeAssistantMeaning, OfAPin_IsItsPlatformAndClass) {
    for (const auto* klass : {"door", "window", "motion", "occupancy", "moisture", "smoke", "vibration"}) {
        EXPECT_EQ(pin_13(of_class(klass))["p"], "binary_sensor") << klass;
        EXPECT_EQ(pin_13(of_class(klass))["dev_cla"], klass);
        EXPECT_FALSE(pin_13(of_class(klass)).contains("en")) << klass;
    }
    EXPECT_EQ(pin_13(of_class("button"))["p"], "binary_sensor");
    EXPECT_FALSE(pin_13(of_class("button")).contains("dev_cla"));
    EXPECT_EQ(pin_13(of_class("plug"))["dev_cla"], "outlet");
    EXPECT_EQ(pin_13(of_class("fan"))["p"], "switch");
    EXPECT_EQ(pin_13(of_class("fan"))["ic"], "mdi:fan");
    auto fan = of_class("fan");
    fan.icon = "mdi:weather-windy";
    fan.hidden = true;
    EXPECT_EQ(pin_13(fan)["ic"], "mdi:weather-windy");
    EXPECT_EQ(pin_13(fan)["en"], false);
}

TEST(HomeAssistantMeaning, LampThatIsOnlyOnOrOff_HasNoBrightness) {
    const auto lamp = pin_13(of_class("light"));
    EXPECT_EQ(lamp["p"], "light");
    EXPECT_EQ(lamp["sup_clrm"], json::array({"onoff"}));
    EXPECT_FALSE(lamp.contains("brightness"));
    auto description = named_description();
    description.labels.meanings["io/13"] = of_class("light");
    const auto board = board_of(description);
    const auto* light = board.property("io-13");
    ASSERT_NE(light, nullptr);
    const HomeAssistant ha({});
    EXPECT_EQ(ha.state_text(*light, {{"on", true}, {"brightness", 255}}),
              R"({"color_mode":"onoff","state":"ON"})");
    EXPECT_TRUE(ha.value_of(*light, R"({"state":"ON"})"));
}

TEST(HomeAssistantMeaning, OfAnAnalogPin_IsItsClassWithItsUnit) {
    auto description = named_description();
    auto& meaning = description.labels.meanings["io/14"];
    meaning = of_class("energy");
    meaning.unit = "kWh";
    meaning.line = {{0, 1023, 0, 100}};
    const auto component = json::parse(HomeAssistant({}).document(board_of(description)))["cmps"]["io-14"];
    EXPECT_EQ(component["dev_cla"], "energy");
    EXPECT_EQ(component["stat_cla"], "total_increasing");
    EXPECT_EQ(component["unit_of_meas"], "kWh");
}

TEST(HomeAssistantNames, OfTheDevice_AreNotSaidTwice) {
    auto board = exported(1, true, "Lamp");
    board.board = "uno1";
    board.properties[0].name = "Lamp";
    board.properties[1].name = "Lamp angle";
    const auto all = json::parse(HomeAssistant({}).document(board))["cmps"];
    EXPECT_TRUE(all["distance-0"].contains("name") && all["distance-0"]["name"].is_null());
    EXPECT_EQ(all["servo-0-angle"]["name"], "angle");
}

TEST(HomeAssistantDocument, LinksToThePageOfTheBoard) {
    HomeAssistant::Options options;
    EXPECT_FALSE(document_of(options)["dev"].contains("cu"));
    options.page = "http://10.0.0.2:8080/";
    EXPECT_EQ(document_of(options)["dev"]["cu"], "http://10.0.0.2:8080/#/board/uno1");
}

TEST(HomeAssistantDocument, OfTheGateway_HasConnectionBoardsAndStart) {
    HomeAssistant::Options options;
    options.version = "1.2.3";
    options.page = "http://10.0.0.2:8080/";
    options.started = "2026-11-27T09:00:00.000Z";
    const HomeAssistant home(options);
    EXPECT_EQ(home.gateway_document_topic(), "homeassistant/device/asip_gateway/config");
    const auto document = json::parse(home.gateway_document({}, {}));
    EXPECT_EQ(document["dev"],
              json::parse(R"({"ids":["asip_gateway"],"name":"ASIP gateway","mf":"ASIP","sw":"1.2.3",)"
                          R"("cu":"http://10.0.0.2:8080/"})"));
    EXPECT_EQ(document["cmps"].size(), 3u);
    for (const auto& component : document["cmps"])
        EXPECT_EQ(component["ent_cat"], "diagnostic");
    const auto standing = json::parse(home.standing(3));
    EXPECT_EQ(standing["boards"], 3);
    EXPECT_EQ(standing["started"], options.started);
    const Dialect::Retained found{{home.gateway_document_topic(), document.dump()},
                                  {"homeassistant/device/other/config", "{}"}};
    EXPECT_TRUE(home.is_ours(found, home.gateway_document_topic(), "homeassistant"));
    EXPECT_FALSE(home.is_ours(found, "homeassistant/device/other/config", "homeassistant"));
}

TEST(HomeAssistantDocument, ReadOnly_HasNothingToSet) {
    HomeAssistant::Options options;
    options.read_only = true;
    const auto document = document_of(options);
    for (const auto& [id, component] : document["cmps"].items()) {
        EXPECT_FALSE(component.contains("cmd_t")) << id;
        EXPECT_TRUE(component["p"] == "sensor" || component["p"] == "binary_sensor") << id;
    }
    EXPECT_FALSE(HomeAssistant(options).value_of(property_of(Kind::kSwitch), "ON"));
}

TEST(HomeAssistantDocument, IdsOfEntities_AreProposedWithTheirDomain) {
    EXPECT_FALSE(document_of()["cmps"]["distance-0"].contains("def_ent_id"));
    HomeAssistant::Options options;
    options.entity_ids = true;
    EXPECT_EQ(document_of(options)["cmps"]["distance-0"]["def_ent_id"], "sensor.uno1_distance_0");
}

TEST(HomeAssistantDocument, TopicIsValidForEachName_AndOneForEachBoard) {
    const HomeAssistant ha({});
    EXPECT_EQ(ha.document_topic("uno-1_b"), "homeassistant/device/asip-uno-1_b/config");
    const auto dotted = ha.document_topic("uno.1");
    EXPECT_EQ(dotted.find('.'), std::string::npos);
    EXPECT_NE(dotted, ha.document_topic("uno_1"));
    EXPECT_NE(dotted, ha.document_topic("uno..1"));
    for (const auto* board : {"uno1", "uno.1", "a-b"})
        EXPECT_TRUE(ha.is_document(ha.document_topic(board), "homeassistant"));
    for (const auto* other : {"homeassistant/device/other/config", "homeassistant/device/asip-x/y/config",
                              "x", "homeassistant/device/asip-x/state", "homeassistant/sensor/asip-x/config"})
        EXPECT_FALSE(ha.is_document(other, "homeassistant")) << other;
}

TEST(HomeAssistantDocument, RemovedComponent_IsNamedByItsPlatformAlone) {
    const HomeAssistant ha({});
    auto board = board_with_all();
    const auto old = ha.components(board);
    EXPECT_EQ(old, HomeAssistant::components_of(ha.document(board)));
    EXPECT_EQ(ha.removing_document(board, old), "");
    board.properties.erase(board.properties.begin());
    auto& changed = board.properties.front();
    changed.kind = Kind::kBinarySensor;
    const auto id = property::plain_id(board_with_all().properties.front().id);
    const auto changed_id = property::plain_id(changed.id);
    const auto document = json::parse(ha.removing_document(board, old));
    EXPECT_EQ(document["cmps"][id], (json{{"p", old.at(id)}}));
    EXPECT_EQ(document["cmps"][changed_id], (json{{"p", old.at(changed_id)}}));
    EXPECT_EQ(json::parse(ha.document(board))["cmps"][changed_id]["p"], "binary_sensor");
}

TEST(HomeAssistantDocument, WhatIsNoDocument_HasNoComponents) {
    for (const auto* text : {"", "[]", "{", R"({"cmps":1})", R"({"cmps":{"a":1,"b":{"p":2}}})"})
        EXPECT_TRUE(HomeAssistant::components_of(text).empty()) << text;
}

TEST(HomeAssistantUnits, ClassIsNamedOnlyForAUnitThatItTakes) {
    EXPECT_EQ(device_class_of("distance", "cm").device_class, "distance");
    EXPECT_EQ(device_class_of("distance", "steps").device_class, "");
    EXPECT_EQ(device_class_of("distance", "").device_class, "");
    EXPECT_EQ(device_class_of("duration", "us").device_class, "");
    EXPECT_EQ(device_class_of("duration", "us").unit, "\xce\xbcs");
    EXPECT_EQ(device_class_of("", "C").unit, "C");
    EXPECT_EQ(device_class_of("angle", "degrees").device_class, "");
}

TEST(HomeAssistantState, IsTextForEachKind) {
    const HomeAssistant ha({});
    EXPECT_EQ(ha.state_text(property_of(Kind::kSwitch), true), "ON");
    EXPECT_EQ(ha.state_text(property_of(Kind::kSensor), 42), "42");
    EXPECT_EQ(ha.state_text(property_of(Kind::kSensor), 4.5), "4.5");
    EXPECT_EQ(ha.state_text(property_of(Kind::kSensor), nullptr), "None");
    EXPECT_EQ(ha.state_text(property_of(Kind::kText), std::string(300, 'a')).size(), 255u);
    EXPECT_EQ(ha.state_text(property_of(Kind::kText), nullptr), "");
    EXPECT_EQ(HomeAssistant::cut(std::string(254, 'a') + "\xc3\xa4").size(), 254u);
    auto light = property_of(Kind::kLight);
    EXPECT_EQ(ha.state_text(light, nullptr), R"({"state":null})");
    EXPECT_EQ(ha.state_text(light, {{"on", true}, {"brightness", 128}}),
              R"({"brightness":128,"color_mode":"brightness","state":"ON"})");
    EXPECT_EQ(ha.state_text(light, {{"on", false}, {"color", 255}}), R"({"state":"OFF"})");
    light.color = light.write;
    EXPECT_EQ(ha.state_text(light, {{"on", true}, {"color", 0x102030}}),
              R"({"color":{"b":48,"g":32,"r":16},"color_mode":"rgb","state":"ON"})");
}

TEST(HomeAssistantCommand, TopicNamesBoardAndEntity) {
    const HomeAssistant ha({});
    const auto command = ha.command_of("asip/export/ha/uno1/io-13/set");
    ASSERT_TRUE(command);
    EXPECT_EQ(command->board, "uno1");
    EXPECT_EQ(command->property, "io-13");
    for (const auto* topic : {"asip/export/ha/uno1/set", "asip/export/ha/set", "asip/export/ha/a/b/c/set",
                              "asip/uno1/io/set", "asip/export/ha/uno1/io-13", ""})
        EXPECT_FALSE(ha.command_of(topic)) << topic;
}

TEST(HomeAssistantCommand, WhatHomeAssistantSends_IsAValue) {
    const HomeAssistant ha({});
    EXPECT_EQ(*ha.value_of(property_of(Kind::kSwitch), "ON"), json(true));
    EXPECT_EQ(*ha.value_of(property_of(Kind::kNumber), "90.0"), json(90.0));
    EXPECT_EQ(*ha.value_of(property_of(Kind::kText), "hello"), json("hello"));
    EXPECT_EQ(*ha.value_of(property_of(Kind::kSelect), "on"), json("on"));
    EXPECT_TRUE(ha.value_of(property_of(Kind::kButton), "PRESS")->is_null());
    auto light = property_of(Kind::kLight);
    light.color = light.write;
    EXPECT_EQ(
        *ha.value_of(light, R"({"state":"ON","brightness":10,"color":{"r":1,"g":2,"b":3},"transition":2})"),
        json({{"on", true}, {"brightness", 10}, {"color", 0x010203}}));
}

TEST(HomeAssistantCommand, WhatIsNoValue_IsRefusedInWords) {
    const HomeAssistant ha({});
    const auto refused = [&](Kind kind, const std::string& payload) {
        const auto value = ha.value_of(property_of(kind), payload);
        EXPECT_FALSE(value) << payload;
        return value ? std::string() : value.error();
    };
    EXPECT_EQ(refused(Kind::kNumber, "101"), "X cannot be set to 101");
    for (const auto* text : {"", "9x", "nan", "inf", "0x10", "1e999"})
        refused(Kind::kNumber, text);
    for (const auto* text : {"", "on", "TOGGLE"})
        refused(Kind::kSwitch, text);
    for (const auto* text : {"", "7", "{}", R"({"state":1})", R"({"state":"ON","brightness":"x"})",
                             R"({"state":"ON","color":{"r":1}})", R"({"state":"ON","color":7})"})
        refused(Kind::kLight, text);
    refused(Kind::kText, std::string(21, 'a'));
    refused(Kind::kSelect, "third");
    refused(Kind::kButton, "ON");
    EXPECT_THAT(refused(Kind::kSensor, "1"), HasSubstr("cannot be set"));
}

TEST(HomeAssistantTest, Button_HasAnEventEntityWithAFrozenId) {
    auto description = named_description();
    description.labels.meanings["io/3"].klass = "button";
    description.labels.meanings["io/2"].klass = "door";
    const auto board = board_of(description);
    const HomeAssistant ha({});
    const auto all = json::parse(ha.document(board))["cmps"];
    EXPECT_EQ(all["io-3--event"],
              json::parse(R"({"p":"event","uniq_id":"asip-uno1_io-3--event","name":"Pin 3 events",
        "dev_cla":"button","stat_t":"asip/export/ha/uno1/io-3--event","evt_typ":["press","release","hold","double"]})"));
    EXPECT_EQ(all["io-3"]["p"], "binary_sensor");
    EXPECT_FALSE(all.contains("io-2--event"));
    EXPECT_EQ(ha.components(board).at("io-3--event"), "event");
    const auto said = ha.act("uno1", *board.property("io-3"), property::ButtonAct::kDouble);
    ASSERT_TRUE(said);
    EXPECT_EQ(said->topic, "asip/export/ha/uno1/io-3--event");
    EXPECT_EQ(said->text, R"({"event_type":"double"})");
    EXPECT_FALSE(ha.act("uno1", *board.property("io-2"), property::ButtonAct::kPress));
    const auto removing = json::parse(ha.removing_document(board_with_all(), ha.components(board)));
    EXPECT_EQ(removing["cmps"]["io-3--event"], json({{"p", "event"}})) << "it is no button any more";
}

}  // namespace
}  // namespace asip::gateway::exports
