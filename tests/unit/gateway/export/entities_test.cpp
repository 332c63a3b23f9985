// SPDX-License-Identifier: Apache-2.0
// What each standard service, pins and services of one's own are shown as.
#include "gateway/export/entities.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace asip::gateway::exports {
namespace {

using model::Description;
using model::ModelSet;
using model::ServiceInfo;
using nlohmann::json;
using testing::ElementsAre;

model::ModelPtr standard(const ServiceInfo& service) {
    return ModelSet::standard().find(service.name);
}

Description board_with(const std::string& service, std::optional<int> count = std::nullopt) {
    Description description;
    description.board = "uno1";
    ServiceInfo info;
    info.name = service;
    const auto model = ModelSet::standard().find(service);
    info.id = model ? model->id : 'X';
    info.count = count;
    description.services.push_back(info);
    return description;
}

constexpr const char* kKinds[] = {"sensor", "binary-sensor", "switch", "number",
                                  "light",  "button",        "text",   "select"};

/// "distance-0 sensor 'Distance 0' cm distance"; a `-` ahead: hidden at first.
std::vector<std::string> seen(const std::vector<Entity>& entities) {
    std::vector<std::string> result;
    for (const auto& each : entities) {
        std::string text = std::string(each.default_on ? "" : "-") + each.id + " " +
                           kKinds[static_cast<int>(each.kind)] + " '" + each.name + "'";
        if (!each.unit.empty()) text += " " + each.unit;
        if (!each.quantity.empty()) text += " " + each.quantity;
        result.push_back(text);
    }
    return result;
}

std::vector<std::string> seen_of(const std::string& service, std::optional<int> count = std::nullopt) {
    return seen(entities_of(board_with(service, count), standard));
}

Entity entity(const std::vector<Entity>& all, const std::string& id) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const auto& each) { return each.id == id; });
    EXPECT_NE(found, all.end()) << id;
    return found == all.end() ? Entity() : *found;
}

TEST(Entities, Distance_IsASensorForEachElement) {
    EXPECT_THAT(seen_of("distance", 2), ElementsAre("distance-0 sensor 'Distance 0' cm distance",
                                                    "distance-1 sensor 'Distance 1' cm distance"));
    EXPECT_THAT(seen_of("distance", 1), ElementsAre("distance-0 sensor 'Distance 0' cm distance"));
    EXPECT_THAT(seen_of("distance"), ElementsAre("distance-0 sensor 'Distance 0' cm distance"));
}

TEST(Entities, EachOtherSensor_HasOneForEachFieldOrElement) {
    EXPECT_THAT(seen_of("pressure"),
                ElementsAre("pressure sensor 'Pressure' hPa pressure",
                            "pressure-temperature sensor 'Pressure temperature' C temperature",
                            "pressure-altitude sensor 'Pressure altitude' m distance"));
    EXPECT_THAT(seen_of("humidity"), ElementsAre("humidity sensor 'Humidity' % humidity"));
    EXPECT_THAT(seen_of("heading"),
                ElementsAre("-heading-x sensor 'Heading x'", "-heading-y sensor 'Heading y'",
                            "-heading-z sensor 'Heading z'", "heading sensor 'Heading' degrees angle"));
    EXPECT_THAT(seen_of("reflectance", 3),
                ElementsAre("reflectance-0 sensor 'Reflectance 0'", "reflectance-1 sensor 'Reflectance 1'",
                            "reflectance-2 sensor 'Reflectance 2'"));
    EXPECT_THAT(seen_of("encoders", 1), ElementsAre("-encoders-0-pulse sensor 'Encoders 0 pulse' us duration",
                                                    "encoders-0-count sensor 'Encoders 0 count' steps"));
    EXPECT_THAT(seen_of("acceleration"), ElementsAre("acceleration-x sensor 'Acceleration x'",
                                                     "acceleration-y sensor 'Acceleration y'",
                                                     "acceleration-z sensor 'Acceleration z'"));
    EXPECT_THAT(seen_of("gyroscope"),
                ElementsAre("gyroscope-x sensor 'Gyroscope x'", "gyroscope-y sensor 'Gyroscope y'",
                            "gyroscope-z sensor 'Gyroscope z'"));
}

TEST(Entities, Bump_IsABinarySensorThatIsOnWhenPressed) {
    const auto all = entities_of(board_with("bump", 2), standard);
    EXPECT_THAT(seen(all), ElementsAre("bump-0 binary-sensor 'Bump 0'", "bump-1 binary-sensor 'Bump 1'"));
    EXPECT_EQ(value_in(all[1], json::parse(R"({"bump":[1,0]})")), json(true));
    EXPECT_EQ(value_in(all[0], json::parse(R"({"bump":[1,0]})")), json(false));
}

TEST(Entities, Servo_IsANumberForEachPinThatTheServiceHas) {
    auto board = board_with("servo");
    board.pins.owners = "@@-------SS---";
    const auto all = entities_of(board, standard);
    EXPECT_THAT(seen(all), ElementsAre("servo-0-angle number 'Servo 0 angle' degrees angle",
                                       "servo-1-angle number 'Servo 1 angle' degrees angle"));
    EXPECT_EQ(all[1].max, 180);
    EXPECT_EQ(requests_for(all[1], 90), (std::vector<Request>{{"servo", R"({"write":[1,90]})"}}));
}

TEST(Entities, MotorsAreHidden_WithOneStopForAll) {
    const auto all = entities_of(board_with("motors"), standard);
    EXPECT_THAT(seen(all),
                ElementsAre("-motors-0-power number 'Motors 0 power'",
                            "-motors-1-power number 'Motors 1 power'", "-motors-stop button 'Motors stop'"));
    EXPECT_EQ(requests_for(all[2], {}), (std::vector<Request>{{"motors", R"({"stop-all":[]})"}}));
}

TEST(Entities, Tone_IsANumberWithAUsualDurationAndAStop) {
    const auto all = entities_of(board_with("tone"), standard);
    EXPECT_THAT(seen(all), ElementsAre("tone-frequency number 'Tone frequency' Hz frequency",
                                       "tone-stop button 'Tone stop'"));
    EXPECT_EQ(requests_for(all[0], 440), (std::vector<Request>{{"tone", R"({"play":[440,500]})"}}));
    EXPECT_EQ(requests_for(all[1], {}), (std::vector<Request>{{"tone", R"({"play":[0,0]})"}}));
}

TEST(Entities, PixelsAreALight) {
    EXPECT_THAT(seen_of("pixels"),
                ElementsAre("pixels light 'Pixels' brightness", "-pixels-count sensor 'Pixels count'"));
    EXPECT_THAT(seen_of("neopixels"), ElementsAre("neopixels-0 light 'Neopixels 0' brightness",
                                                  "-neopixels-0-show button 'Neopixels 0 show'"));
}

TEST(Entities, Display_IsATextForEachLine) {
    const auto all = entities_of(board_with("lcd"), standard);
    EXPECT_THAT(seen(all), ElementsAre("lcd-clear button 'Lcd clear'", "lcd-0-text text 'Lcd 0 text'",
                                       "lcd-1-text text 'Lcd 1 text'", "lcd-2-text text 'Lcd 2 text'",
                                       "lcd-3-text text 'Lcd 3 text'", "lcd-4-text text 'Lcd 4 text'"));
    EXPECT_EQ(all[1].max_length, 21u);
}

TEST(Entities, EachStandardService_HasSome) {
    for (const auto& model : ModelSet::standard().all()) {
        if (model->name == "io") continue;  // its pins are shown
        EXPECT_FALSE(seen_of(model->name).empty()) << model->name;
    }
}

Description board_with_pins() {
    auto board = board_with("io");
    board.pins.capabilities = "11111511111111113333";
    board.pins.owners = "@@-------S----------";
    board.pins.modes = "66120500070003400000";
    board.pins.analog = {{14, 0}, {15, 1}, {16, 2}};
    return board;
}

TEST(PinEntities, PinsWithAMode_AreShownAsTheirMode) {
    const auto all = entities_of(board_with_pins(), standard);
    EXPECT_THAT(seen(all),
                ElementsAre("-pin-2 binary-sensor 'Pin 2'", "-pin-3 binary-sensor 'Pin 3'",
                            "-pin-5 number 'Pin 5'", "-pin-13 switch 'Pin 13'", "-pin-14 sensor 'Pin 14'"));
    EXPECT_EQ(value_in(all[0], json::parse(R"({"digital":{"2":1}})")), json(true));
    EXPECT_EQ(value_in(all[4], json::parse(R"({"analog":{"0":512}})")), json(512));
    EXPECT_EQ(requests_for(all[3], true), (std::vector<Request>{{"io", R"({"write":[13,1]})"}}));
    EXPECT_EQ(requests_for(all[2], 128), (std::vector<Request>{{"io", R"({"pwm":[5,128]})"}}));
}

TEST(PinEntities, Label_IsItsNameAndShowsIt) {
    auto board = board_with_pins();
    board.labels.pins[13] = "status lamp";
    board.labels.pins[9] = "of the servo service: not a pin of ours";
    EXPECT_EQ(seen(entities_of(board, standard))[3], "pin-13 switch 'status lamp'");
}

TEST(PinEntities, LabelledPinWithoutMode_BecomesAnOutputWhenItIsSet) {
    auto board = board_with_pins();
    board.labels.pins[8] = "pump";
    const auto all = entities_of(board, standard);
    const auto pump = entity(all, "pin-8");
    EXPECT_FALSE(pump.default_on);
    EXPECT_EQ(requests_for(pump, true),
              (std::vector<Request>{{"io", R"({"mode":[8,3]})"}, {"io", R"({"write":[8,1]})"}}));
}

TEST(PinEntities, BoardLabelledAsLight_HasLightsAtItsPwmPins) {
    auto board = board_with_pins();
    board.labels.labels["kind"] = "light";
    EXPECT_EQ(entity(entities_of(board, standard), "pin-5").kind, EntityKind::kLight);
}

TEST(Entities, LabelOfAService_IsTheName) {
    auto board = board_with("servo");
    board.labels.services["servo"] = "left arm";
    EXPECT_EQ(entities_of(board, standard)[0].name, "left arm");
    board.pins.owners = "SS";
    EXPECT_EQ(entities_of(board, standard)[1].name, "left arm 1");
}

/// Of a model of one's own, as JSON, without any of the optional members.
std::vector<Entity> of_own(const char* parts, std::optional<int> count = std::nullopt) {
    auto document = json::parse(parts);
    document.update({{"name", "own"}, {"version", 1}, {"id", "X"}, {"title", "Own"}});
    const auto made = model::service_model_from_json(document);
    if (!made) throw std::runtime_error(made.error());
    const auto model = std::make_shared<const model::ServiceModel>(*made);
    return entities_of(board_with("own", count), [&](const ServiceInfo&) { return model; });
}

TEST(OwnService, CommandsAreWhatTheirArgumentsSay) {
    const auto all = of_own(R"({"element":"fan","commands":{
      "power":{"tag":"W","args":[{"name":"fan","type":"integer","min":0,"max":1},
                                 {"name":"power","type":"integer","unit":"%","min":0,"max":100,"names":{"off":0,"full":100}}]},
      "mode":{"tag":"M","args":[{"name":"mode","type":"integer","names":{"eco":0,"normal":1,"turbo":2}}]},
      "swing":{"tag":"S","args":[{"name":"swing","type":"integer","names":{"on":0,"off":1}}]},
      "tint":{"tag":"T","args":[{"name":"tint","type":"color"}]},
      "beep":{"tag":"B"}}})");
    EXPECT_THAT(seen(all), ElementsAre("own light 'Own'", "own-beep button 'Own beep'",
                                       "own-mode select 'Own mode'", "own-0-power number 'Own 0 power' %",
                                       "own-1-power number 'Own 1 power' %", "own-swing switch 'Own swing'"));
    EXPECT_EQ(requests_for(entity(all, "own-mode"), "turbo")[0].payload, R"({"mode":[2]})");
    EXPECT_EQ(requests_for(entity(all, "own-swing"), true)[0].payload, R"({"swing":[0]})");
    EXPECT_TRUE(requests_for(entity(all, "own-mode"), "fast").empty());
}

TEST(OwnService, EventThatShowsWhatWasSet_IsTheStateOfTheSwitch) {
    const auto all = of_own(R"({"element":"relay","elements":2,
      "events":{"e":{"name":"state","fields":[{"name":"closed","type":"integer","min":0,"max":1}]}},
      "commands":{"set":{"tag":"W","writes":"state","args":[
        {"name":"relay","type":"integer","min":0,"max":7},{"name":"closed","type":"integer","min":0,"max":1}]}}})");
    EXPECT_THAT(seen(all),
                ElementsAre("own-0-closed switch 'Own 0 closed'", "own-1-closed switch 'Own 1 closed'"));
    EXPECT_EQ(value_in(all[1], json::parse(R"({"state":[0,1]})")), json(true));
}

TEST(OwnService, WithoutAModel_HasNoEntities) {
    EXPECT_TRUE(entities_of(board_with("nothing"), standard).empty());
}

TEST(Entities, NamesThatDifferInWhatASlugHasNot_StayApart) {
    Description board;
    for (const auto* name : {"a.b", "a-b"}) {
        ServiceInfo info;
        info.name = name;
        info.id = 'D';
        board.services.push_back(info);
    }
    const auto all =
        entities_of(board, [](const ServiceInfo&) { return ModelSet::standard().find("humidity"); });
    ASSERT_EQ(all.size(), 2u);
    EXPECT_EQ(all[0].id, "a-b-humidity");
    EXPECT_EQ(all[1].id, "a-b-humidity-2");
}

TEST(Entities, TheirNumber_IsBounded) {
    Description board;
    for (int i = 0; i < 64; ++i) {
        ServiceInfo info;
        info.name = "d" + std::to_string(i);
        info.count = 65535;
        board.services.push_back(info);
    }
    EXPECT_EQ(
        entities_of(board, [](const ServiceInfo&) { return ModelSet::standard().find("distance"); }).size(),
        kMaxEntities);
}

TEST(Slug, IsMadeOfAnyText) {
    EXPECT_EQ(slug_of("Left Arm #2"), "left-arm-2");
    EXPECT_EQ(slug_of("--\xc3\xa4--"), "x");
}

}  // namespace
}  // namespace asip::gateway::exports
