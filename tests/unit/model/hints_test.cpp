// SPDX-License-Identifier: Apache-2.0
#include "asip/model/hints.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "asip/model/model_set.hpp"

namespace asip::model {
namespace {

nlohmann::json relay_model() {
    return nlohmann::json::parse(R"({
      "name": "relay", "version": 1, "id": "Y", "title": "Relays", "element": "relay", "elements": 4,
      "events": {"e": {"name": "state", "per": "element",
        "fields": [{"name": "closed", "type": "integer", "min": 0, "max": 1, "on": 1},
                   {"name": "volt", "type": "number", "unit": "V", "quantity": "voltage", "step": 0.1, "advanced": true}]}},
      "commands": {"set": {"tag": "W", "writes": "state.closed", "args": [
        {"name": "relay", "type": "integer", "min": 0, "max": 3},
        {"name": "closed", "type": "integer", "min": 0, "max": 1},
        {"name": "after", "type": "integer", "min": 0, "max": 99, "default": 5}]}}})");
}

std::string hints_fault_of(const nlohmann::json& document) {
    const auto model = service_model_from_json(document);
    return model ? "" : model.error();
}

TEST(ModelHints, Members_AreRead) {
    const auto model = service_model_from_json(relay_model());
    ASSERT_TRUE(model) << model.error();
    const ModelHints hints(*model);
    const auto& event = model->events[0];
    const auto& command = model->commands[0];
    EXPECT_EQ(hints.elements(), 4);
    EXPECT_FALSE(hints.element_for_each_pin());
    EXPECT_EQ(hints.field(event, "closed").on, 1);
    EXPECT_EQ(hints.field(event, "volt").quantity, "voltage");
    EXPECT_EQ(hints.field(event, "volt").step, 0.1);
    EXPECT_TRUE(hints.field(event, "volt").advanced);
    EXPECT_EQ(hints.argument(command, "after").default_value, 5);
    ASSERT_TRUE(hints.shown_by(command));
    EXPECT_EQ(hints.shown_by(command)->event, "state");
    EXPECT_EQ(hints.shown_by(command)->field, "closed");
    EXPECT_FALSE(hints.advanced(command));
}

TEST(ModelHints, ModelWithoutAny_HasNone) {
    const auto model = ModelSet::standard().find("acceleration");
    const ModelHints hints(*model);
    EXPECT_EQ(hints.field(model->events[0], "x").quantity, "");
    EXPECT_FALSE(hints.elements());
    EXPECT_FALSE(hints.shown_by(model->commands[0]));
}

TEST(ModelHints, AdvancedEvent_IsThatOfItsFields) {
    const auto model = ModelSet::standard().find("pixels");
    EXPECT_TRUE(ModelHints(*model).field(model->events[0], "count").advanced);
}

TEST(ModelHints, WhatContradictsTheModel_IsRefusedWithItsPlace) {
    auto model = relay_model();
    model["commands"]["set"]["writes"] = "level";
    EXPECT_EQ(hints_fault_of(model), "/commands/set/writes: there is no event \"level\"");
    model["commands"]["set"]["writes"] = "state";
    EXPECT_EQ(hints_fault_of(model),
              "/commands/set/writes: event \"state\" has several fields: write EVENT.FIELD");
    model["commands"]["set"]["writes"] = "state.open";
    EXPECT_EQ(hints_fault_of(model), "/commands/set/writes: event \"state\" has no field \"open\"");
    model = relay_model();
    model["commands"]["set"]["args"][2]["default"] = 100;
    EXPECT_EQ(hints_fault_of(model), "/commands/set/args/2/default: 100 is above 99");
    model["commands"]["set"]["args"][2] = {{"name", "text"}, {"type", "text"}, {"default", 1}};
    EXPECT_EQ(hints_fault_of(model), "/commands/set/args/2/default: only a number has a default");
}

TEST(ModelHints, WhatTheSchemaDoesNotKnow_IsRefused) {
    auto model = relay_model();
    model["events"]["e"]["fields"][1]["quantity"] = "volts";
    EXPECT_TRUE(hints_fault_of(model).starts_with("/events/e/fields/1/quantity: is \"volts\", not one of ["))
        << hints_fault_of(model);
    model = relay_model();
    model["events"]["e"]["fields"][1]["step"] = 0;
    EXPECT_EQ(hints_fault_of(model), "/events/e/fields/1/step: 0 is below 0.001");
    model = relay_model();
    model["elements"] = "some";
    EXPECT_EQ(hints_fault_of(model), "/elements: fits none of the forms allowed here");
}

}  // namespace
}  // namespace asip::model
