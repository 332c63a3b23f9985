// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/home_assistant.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "asip/model/model_set.hpp"
#include "gateway/export/entities.hpp"

namespace asip::gateway::exports {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// A board with every standard service and pins in each mode.
ExportedBoard board_with_all() {
    model::Description description;
    description.board = "uno1";
    for (const auto& model : model::ModelSet::standard().all()) {
        model::ServiceInfo info;
        info.name = model->name;
        info.id = model->id;
        description.services.push_back(info);
    }
    description.pins.capabilities = "1111111111111111";
    description.pins.owners = "------------------";
    description.pins.modes = "00123450000000400000";
    description.pins.analog = {{14, 0}};
    description.labels.pins[4] = "lamp";
    ExportedBoard board;
    board.board = "uno1";
    board.name = "Desk";
    board.chip = "ATmega328P";
    board.room = "lab";
    board.entities = entities_of(description, [](const model::ServiceInfo& service) {
        return model::ModelSet::standard().find(service.name);
    });
    return board;
}

json document_of(const HomeAssistant::Options& options = {}) {
    return json::parse(HomeAssistant(options).document(board_with_all()));
}

Entity entity_of(EntityKind kind) {
    Entity entity;
    entity.id = "x";
    entity.name = "X";
    entity.kind = kind;
    entity.write = Call{"own", "set", {std::nullopt}, "value"};
    entity.options = {{"off", 0}, {"on", 1}};
    entity.min = 0;
    entity.max = 100;
    entity.max_length = 20;
    return entity;
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
              json::parse(R"({"p":"sensor","uniq_id":"asip-uno1_distance-0","name":"Distance 0","stat_t":
                  "asip/export/ha/uno1/distance-0","unit_of_meas":"cm","dev_cla":"distance","stat_cla":"measurement"})"));
    EXPECT_EQ(all["pressure-temperature"]["unit_of_meas"],
              "\xc2\xb0"
              "C");
    EXPECT_EQ(all["heading"]["stat_cla"], "measurement_angle");
    EXPECT_EQ(all["servo-0-angle"]["unit_of_meas"], "\xc2\xb0");
    EXPECT_EQ(all["servo-0-angle"]["cmd_t"], "asip/export/ha/uno1/servo-0-angle/set");
    EXPECT_EQ(all["pin-4"]["p"], "switch");
    EXPECT_EQ(all["pin-4"]["name"], "lamp");
    EXPECT_FALSE(all["pin-4"].contains("en"));
    EXPECT_EQ(all["pin-2"]["en"], false);
    EXPECT_EQ(all["last-error"]["ent_cat"], "diagnostic");
}

TEST(HomeAssistantDocument, ReadOnly_HasNothingToSet) {
    HomeAssistant::Options options;
    options.read_only = true;
    const auto document = document_of(options);
    for (const auto& [id, component] : document["cmps"].items()) {
        EXPECT_FALSE(component.contains("cmd_t")) << id;
        EXPECT_TRUE(component["p"] == "sensor" || component["p"] == "binary_sensor") << id;
    }
    EXPECT_FALSE(HomeAssistant(options).value_of(entity_of(EntityKind::kSwitch), "ON"));
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
    board.entities.erase(board.entities.begin());
    auto& changed = board.entities.front();
    changed.kind = EntityKind::kBinarySensor;
    const auto id = board_with_all().entities.front().id;
    const auto document = json::parse(ha.removing_document(board, old));
    EXPECT_EQ(document["cmps"][id], (json{{"p", old.at(id)}}));
    EXPECT_EQ(document["cmps"][changed.id], (json{{"p", old.at(changed.id)}}));
    EXPECT_EQ(json::parse(ha.document(board))["cmps"][changed.id]["p"], "binary_sensor");
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
    EXPECT_EQ(ha.state_text(entity_of(EntityKind::kSwitch), true), "ON");
    EXPECT_EQ(ha.state_text(entity_of(EntityKind::kSensor), 42), "42");
    EXPECT_EQ(ha.state_text(entity_of(EntityKind::kSensor), 4.5), "4.5");
    EXPECT_EQ(ha.state_text(entity_of(EntityKind::kSensor), nullptr), "None");
    EXPECT_EQ(ha.state_text(entity_of(EntityKind::kText), std::string(300, 'a')).size(), 255u);
    EXPECT_EQ(ha.state_text(entity_of(EntityKind::kText), nullptr), "");
    EXPECT_EQ(HomeAssistant::cut(std::string(254, 'a') + "\xc3\xa4").size(), 254u);
    auto light = entity_of(EntityKind::kLight);
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
    const auto command = ha.command_of("asip/export/ha/uno1/pin-13/set");
    ASSERT_TRUE(command);
    EXPECT_EQ(command->board, "uno1");
    EXPECT_EQ(command->entity, "pin-13");
    for (const auto* topic : {"asip/export/ha/uno1/set", "asip/export/ha/set", "asip/export/ha/a/b/c/set",
                              "asip/uno1/io/set", "asip/export/ha/uno1/pin-13", ""})
        EXPECT_FALSE(ha.command_of(topic)) << topic;
}

TEST(HomeAssistantCommand, WhatHomeAssistantSends_IsAValue) {
    const HomeAssistant ha({});
    EXPECT_EQ(*ha.value_of(entity_of(EntityKind::kSwitch), "ON"), json(true));
    EXPECT_EQ(*ha.value_of(entity_of(EntityKind::kNumber), "90.0"), json(90.0));
    EXPECT_EQ(*ha.value_of(entity_of(EntityKind::kText), "hello"), json("hello"));
    EXPECT_EQ(*ha.value_of(entity_of(EntityKind::kSelect), "on"), json("on"));
    EXPECT_TRUE(ha.value_of(entity_of(EntityKind::kButton), "PRESS")->is_null());
    auto light = entity_of(EntityKind::kLight);
    light.color = light.write;
    EXPECT_EQ(
        *ha.value_of(light, R"({"state":"ON","brightness":10,"color":{"r":1,"g":2,"b":3},"transition":2})"),
        json({{"on", true}, {"brightness", 10}, {"color", 0x010203}}));
}

TEST(HomeAssistantCommand, WhatIsNoValue_IsRefusedInWords) {
    const HomeAssistant ha({});
    const auto refused = [&](EntityKind kind, const std::string& payload) {
        const auto value = ha.value_of(entity_of(kind), payload);
        EXPECT_FALSE(value) << payload;
        return value ? std::string() : value.error();
    };
    EXPECT_EQ(refused(EntityKind::kNumber, "101"), "X cannot be set to 101");
    for (const auto* text : {"", "9x", "nan", "inf", "0x10", "1e999"})
        refused(EntityKind::kNumber, text);
    for (const auto* text : {"", "on", "TOGGLE"})
        refused(EntityKind::kSwitch, text);
    for (const auto* text : {"", "7", "{}", R"({"state":1})", R"({"state":"ON","brightness":"x"})",
                             R"({"state":"ON","color":{"r":1}})", R"({"state":"ON","color":7})"})
        refused(EntityKind::kLight, text);
    refused(EntityKind::kText, std::string(21, 'a'));
    refused(EntityKind::kSelect, "third");
    refused(EntityKind::kButton, "ON");
    EXPECT_THAT(refused(EntityKind::kSensor, "1"), HasSubstr("cannot be set"));
}

}  // namespace
}  // namespace asip::gateway::exports
