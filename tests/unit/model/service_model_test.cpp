// SPDX-License-Identifier: Apache-2.0
#include "asip/model/service_model.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "asip/model/model_set.hpp"

namespace asip::model {
namespace service_model_test {

using nlohmann::json;
using testing::HasSubstr;

const json kFan = json::parse(R"({
  "name": "fan", "version": 2, "id": "F", "match": ["Fan"], "title": "A fan",
  "events": { "e": { "name": "speed", "per": "event", "fields": [{ "name": "rpm", "type": "integer", "unit": "rpm" }] } },
  "commands": { "speed": { "tag": "S", "args": [{ "name": "percent", "type": "integer", "min": 0, "max": 100 }], "answer": "e" } },
  "examples": [{ "json": { "speed": 50 }, "wire": "F,S,50" }]
})");

std::string fault(const char* path, const json& value) {
    auto document = kFan;
    document[json::json_pointer(path)] = value;
    const auto model = service_model_from_json(document);
    return model ? "" : model.error();
}

TEST(ServiceModel, ValidDocument_IsRead) {
    const auto model = service_model_from_json(kFan);
    ASSERT_TRUE(model) << model.error();
    EXPECT_EQ(model->ref(), "fan@2");
    EXPECT_EQ(model->event('e')->fields.front().unit, "rpm");
    EXPECT_EQ(model->event_named("speed"), model->event('e'));
    EXPECT_EQ(model->command("speed")->answer, 'e');
    EXPECT_EQ(model->command_with_tag('S'), model->command("speed"));
    EXPECT_EQ(model->command("stop"), nullptr);
    EXPECT_EQ(examples(*model).size(), 1u);
    EXPECT_EQ(model->source.find("examples"), std::string::npos);
}

TEST(ServiceModel, BrokenDocument_IsRefusedWithPlaceAndReason) {
    EXPECT_EQ(fault("/id", "FF"), "/id: \"FF\" does not match ^[A-Z]$");
    EXPECT_EQ(fault("/name", "Fan fan"), "/name: \"Fan fan\" does not match ^[a-z][a-z0-9._-]{1,31}$");
    EXPECT_EQ(fault("/version", 0), "/version: 0 is below 1");
    EXPECT_EQ(fault("/title", "\x1b[2J"), "/title: holds control characters");
    EXPECT_EQ(fault("/\x1b[2J", 1), "/\\x1b[2J: no such member is known here");
    EXPECT_EQ(fault("/colour", "red"), "/colour: no such member is known here");
    EXPECT_EQ(
        fault("/commands/speed/args/0/type", "int"),
        R"(/commands/speed/args/0/type: is "int", not one of ["integer","number","text","color","count","list"])");
    EXPECT_THAT(fault("/events/ee", json::object()), HasSubstr("/events/ee: \"ee\" does not match"));
    EXPECT_THAT(fault("/commands/Speed", json::object()), HasSubstr("/commands/Speed"));
}

TEST(ServiceModel, Contradiction_IsRefusedWithPlaceAndReason) {
    EXPECT_EQ(fault("/commands/speed/answer", "x"), "/commands/speed/answer: there is no event \"x\"");
    EXPECT_EQ(fault("/commands/speed/args/0/min", 200), "/commands/speed/args/0/min: is above max");
    EXPECT_EQ(fault("/commands/speed/args/0/type", "list"),
              "/commands/speed/args/0: has no member \"items\"");
    EXPECT_EQ(fault("/commands/speed/args/0/type", "count"), "/commands/speed/args/0/of: \"\" is not a list");
    EXPECT_EQ(fault("/commands/speed/args/1", {{"name", "percent"}, {"type", "integer"}}),
              "/commands/speed/args/1/name: \"percent\" is there twice");
    EXPECT_EQ(fault("/events/f", {{"name", "speed"}, {"fields", kFan["events"]["e"]["fields"]}}),
              "/events/f/name: \"speed\" is there twice");
    EXPECT_EQ(fault("/events/f", {{"name", "other"}}), "/events/f: has no member \"fields\"");
    auto text_first = json::array({{{"name", "t"}, {"type", "text"}}, {{"name", "n"}, {"type", "integer"}}});
    EXPECT_EQ(fault("/commands/speed/args", text_first),
              "/commands/speed/args/0/type: a text must come last");
}

/// The fault of a model whose command `speed` has this safe form, and whose service has the other.
std::string safe_fault(const char* safe, const char* whole = nullptr) {
    auto document = kFan;
    document["commands"] = json::parse(R"({
      "speed": { "tag": "S", "args": [{ "name": "fan", "type": "integer", "min": 0, "max": 7 },
                                      { "name": "percent", "type": "integer", "min": 0, "max": 100 }] },
      "off": { "tag": "O", "args": [{ "name": "fan", "type": "integer", "min": 0, "max": 3 }] },
      "whirl": { "tag": "W", "args": [{ "name": "turns", "type": "integer" }] }
    })");
    document["commands"]["speed"]["safe"] = json::parse(safe);
    if (whole != nullptr) document["safe"] = json::parse(whole);
    const auto model = service_model_from_json(document);
    return model ? "" : model.error();
}

TEST(ServiceModel, SafeFormThatCannotBeSent_IsRefusedWithPlaceAndReason) {
    EXPECT_EQ(safe_fault("[null,0]"), "");
    EXPECT_EQ(safe_fault("[null,101]"), "/commands/speed/safe/1: 101 is above 100");
    EXPECT_EQ(safe_fault("[null,0.5]"), "/commands/speed/safe/1: 0.5 is not an integer");
    EXPECT_EQ(safe_fault("[0]"), "/commands/speed/safe: has 1 arguments, but speed takes 2");
    EXPECT_EQ(safe_fault("\"halt\""), "/commands/speed/safe: there is no command \"halt\"");
    EXPECT_EQ(safe_fault("\"speed\""), "/commands/speed/safe: is the command itself");
    EXPECT_EQ(safe_fault("\"off\""), "/commands/speed/safe: off does not take every fan");
    EXPECT_EQ(safe_fault("\"whirl\""),
              "/commands/speed/safe: whirl needs 'turns', which speed does not have");
    EXPECT_EQ(safe_fault("[\"zero\"]"), "/commands/speed/safe: fits none of the forms allowed here");
}

TEST(ServiceModel, HoldWithoutASafeForm_IsRefused) {
    auto document =
        json::parse(R"({"name":"fan","version":1,"id":"F","title":"Fan","commands":{"speed":{"tag":"S",
        "hold":true,"args":[{"name":"percent","type":"integer","min":0,"max":100}]}}})");
    const auto refused = service_model_from_json(document);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error(), HasSubstr("/commands/speed/hold: needs \"safe\""));
    document["commands"]["speed"]["safe"] = json::array({0});
    EXPECT_TRUE(service_model_from_json(document)) << "what undoes it is known";
    document["commands"]["speed"]["hold"] = "yes";
    EXPECT_FALSE(service_model_from_json(document)) << "true or false";
}

TEST(ServiceModel, SafeStateOfTheWholeService_IsReadAsRequestLines) {
    EXPECT_EQ(safe_fault("[null,0]", R"([{"speed":[0,101]}])"), "/safe/0: percent: 101 is above 100");
    EXPECT_THAT(safe_fault("[null,0]", R"([{"halt":null}])"), HasSubstr("/safe/0: no command 'halt'"));
    EXPECT_EQ(safe_fault("[null,0]", "[]"), "/safe: has fewer than 1 items");
    auto document = kFan;
    document["safe"] = json::parse(R"([{"speed":0},{"speed":10}])");
    const auto model = service_model_from_json(document);
    ASSERT_TRUE(model) << model.error();
    EXPECT_EQ(model->safe, (std::vector<std::string>{"F,S,0", "F,S,10"}));
}

TEST(ServiceModel, HostileText_IsRefused) {
    for (const std::string_view text : {"", "[]", "null", "{", "{\"name\":7}"})
        EXPECT_FALSE(parse_service_model(text)) << text;
    EXPECT_FALSE(parse_service_model(std::string(100000, '[')));
}

struct NameCase {
    char letter;
    const char* friendly;
    const char* model;
};

TEST(Matches, NamesOfDeployedBoards_FindTheirModel) {
    const auto& models = ModelSet::standard();
    for (const auto& [letter, friendly, name] :
         std::initializer_list<NameCase>{{'I', "ASIP core IO", "io"},
                                         {'I', "", "io"},
                                         {'D', "Distance", "distance"},
                                         {'D', "HC-SR04 distance sensor", "distance"},
                                         {'S', "Servos", "servo"},
                                         {'R', "IR Reflectance", "reflectance"},
                                         {'R', "IR Sensors", "reflectance"},
                                         {'B', "Bump Sensors", "bump"},
                                         {'M', "Motors", "motors"},
                                         {'C', "Climate", "climate"},
                                         {'K', "Thermometers", "thermometers"},
                                         {'O', "OneWire", "onewire"},
                                         {'J', "I2C", "i2c"},
                                         {'W', "Weather", "weather"},
                                         {'E', "Encoders", "encoders"},
                                         {'T', "Tone", "tone"},
                                         {'P', "Pixels", "pixels"},
                                         {'P', "Pressure", "pressure"},
                                         {'L', "LCD", "lcd"},
                                         {'A', "Accelerometer", "acceleration"},
                                         {'A', "Acceleration", "acceleration"},
                                         {'G', "GYROSCOPE", "gyroscope"},
                                         {'H', "Heading", "heading"},
                                         {'H', "Magnetometer", "heading"},
                                         {'H', "", "heading"},
                                         {'H', "Humidity", "humidity"},
                                         {'N', "NeoPixels", "neopixels"}}) {
        const auto model = models.match(letter, friendly);
        ASSERT_TRUE(model) << friendly;
        EXPECT_EQ(model->name, name) << friendly;
    }
}

TEST(Matches, OtherLetterOrOtherName_FindsNone) {
    EXPECT_FALSE(ModelSet::standard().match('D', "Servos"));
    EXPECT_FALSE(ModelSet::standard().match('X', "Distance"));
    EXPECT_FALSE(ModelSet::standard().match('X', ""));
    EXPECT_FALSE(ModelSet::standard().match('I', "Ion radio"));
}

}  // namespace service_model_test
}  // namespace asip::model
