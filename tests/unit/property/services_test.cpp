// SPDX-License-Identifier: Apache-2.0
// What each standard service, pins and services of one's own are shown as.

#include "asip/property/value.hpp"
#include "tests/unit/property/boards.hpp"

namespace asip::property::test {
namespace {

using model::Description;
using model::ServiceInfo;
using nlohmann::json;
using testing::ElementsAre;

Description board_of(const std::string& service, std::optional<int> count = std::nullopt) {
    auto board = board_with({});
    add_service(board, service, count);
    return board;
}

constexpr const char* kKinds[] = {"sensor", "binary-sensor", "switch", "number",
                                  "light",  "button",        "text",   "select"};

/// "distance/0 sensor 'Distance 0' cm distance"; a `-` ahead: hidden at first.
std::vector<std::string> seen(const std::vector<Property>& entities) {
    std::vector<std::string> result;
    for (const auto& each : entities) {
        std::string text = std::string(each.advanced ? "-" : "") + each.id + " " +
                           kKinds[static_cast<int>(each.kind)] + " '" + each.name + "'";
        if (!each.unit.empty()) text += " " + each.unit;
        if (!each.quantity.empty()) text += " " + each.quantity;
        result.push_back(text);
    }
    return result;
}

std::vector<std::string> seen_of(const std::string& service, std::optional<int> count = std::nullopt) {
    return seen(properties_of(board_of(service, count), standard));
}

TEST(ServiceProperties, Distance_IsASensorForEachElement) {
    EXPECT_THAT(seen_of("distance", 2), ElementsAre("distance/0 sensor 'Distance 0' cm distance",
                                                    "distance/1 sensor 'Distance 1' cm distance"));
    EXPECT_THAT(seen_of("distance", 1), ElementsAre("distance/0 sensor 'Distance' cm distance"));
    EXPECT_THAT(seen_of("distance"), ElementsAre("distance/0 sensor 'Distance' cm distance"));
}

TEST(ServiceProperties, EachOtherSensor_HasOneForEachFieldOrElement) {
    EXPECT_THAT(seen_of("pressure"),
                ElementsAre("pressure sensor 'Pressure' hPa pressure",
                            "pressure/temperature sensor 'Pressure temperature' C temperature",
                            "pressure/altitude sensor 'Pressure altitude' m distance"));
    EXPECT_THAT(seen_of("humidity"), ElementsAre("humidity sensor 'Humidity' % humidity"));
    EXPECT_THAT(seen_of("climate"),
                ElementsAre("-climate/0/damaged sensor 'Climate damaged'",
                            "-climate/0/silent sensor 'Climate silent'",
                            "climate/0/temperature sensor 'Climate temperature' C temperature",
                            "climate/0/humidity sensor 'Climate humidity' % humidity"));
    EXPECT_THAT(
        seen_of("thermometers", 1),
        testing::Contains("thermometers/0/temperature sensor 'Thermometers temperature' C temperature"));
    EXPECT_THAT(seen_of("weather"),
                ElementsAre("weather/temperature sensor 'Weather temperature' C temperature",
                            "weather/humidity sensor 'Weather humidity' % humidity",
                            "weather/pressure sensor 'Weather pressure' hPa pressure"));
    EXPECT_THAT(seen_of("illuminance"), ElementsAre("illuminance sensor 'Illuminance' lx illuminance"));
    EXPECT_THAT(seen_of("hygrometer"),
                ElementsAre("-hygrometer/damaged sensor 'Hygrometer damaged'",
                            "hygrometer/temperature sensor 'Hygrometer temperature' C temperature",
                            "hygrometer/humidity sensor 'Hygrometer humidity' % humidity"));
    EXPECT_THAT(seen_of("heading"),
                ElementsAre("-heading/x sensor 'Heading x'", "-heading/y sensor 'Heading y'",
                            "-heading/z sensor 'Heading z'", "heading sensor 'Heading' degrees angle"));
    EXPECT_THAT(seen_of("reflectance", 3),
                ElementsAre("reflectance/0 sensor 'Reflectance 0'", "reflectance/1 sensor 'Reflectance 1'",
                            "reflectance/2 sensor 'Reflectance 2'"));
    EXPECT_THAT(seen_of("encoders", 1), ElementsAre("-encoders/0/pulse sensor 'Encoders pulse' us duration",
                                                    "encoders/0/count sensor 'Encoders count' steps"));
    EXPECT_THAT(seen_of("acceleration"), ElementsAre("acceleration/x sensor 'Acceleration x'",
                                                     "acceleration/y sensor 'Acceleration y'",
                                                     "acceleration/z sensor 'Acceleration z'"));
    EXPECT_THAT(seen_of("gyroscope"),
                ElementsAre("gyroscope/x sensor 'Gyroscope x'", "gyroscope/y sensor 'Gyroscope y'",
                            "gyroscope/z sensor 'Gyroscope z'"));
}

TEST(ServiceProperties, Bump_IsABinarySensorThatIsOnWhenPressed) {
    const auto all = properties_of(board_of("bump", 2), standard);
    EXPECT_THAT(seen(all), ElementsAre("bump/0 binary-sensor 'Bump 0'", "bump/1 binary-sensor 'Bump 1'"));
    EXPECT_EQ(value_in(all[1], json::parse(R"({"bump":[1,0]})")), json(true));
    EXPECT_EQ(value_in(all[0], json::parse(R"({"bump":[1,0]})")), json(false));
}

TEST(ServiceProperties, Servo_IsANumberForEachPinThatTheServiceHas) {
    auto board = board_of("servo");
    board.pins.owners = "@@-------SS---";
    const auto all = properties_of(board, standard);
    EXPECT_THAT(seen(all), ElementsAre("servo/0/angle number 'Servo 0 angle' degrees angle",
                                       "servo/1/angle number 'Servo 1 angle' degrees angle"));
    EXPECT_EQ(all[1].max, 180);
    EXPECT_EQ(requests_for(all[1], 90), (std::vector<Request>{{"servo", R"({"write":[1,90]})"}}));
}

TEST(ServiceProperties, StepperIsANumberThatIsReportedBesideWhatItDoes) {
    const auto all = properties_of(board_of("steppers", 1), standard);
    EXPECT_THAT(seen(all), testing::IsSupersetOf({"steppers/0/moving binary-sensor 'Steppers moving'",
                                                  "steppers/0/homed binary-sensor 'Steppers homed'",
                                                  "steppers/0/position number 'Steppers position' steps",
                                                  "-steppers/0/speed number 'Steppers speed'",
                                                  "-steppers/0/power switch 'Steppers power'",
                                                  "steppers/stop button 'Steppers stop'"}));
    EXPECT_EQ(requests_for(all.back(), {}), (std::vector<Request>{{"steppers", R"({"stop-all":[]})"}}));
}

TEST(ServiceProperties, MotorsAreHidden_WithOneStopForAll) {
    const auto all = properties_of(board_of("motors"), standard);
    EXPECT_THAT(seen(all),
                ElementsAre("-motors/0/power number 'Motors 0 power'",
                            "-motors/1/power number 'Motors 1 power'", "-motors/stop button 'Motors stop'"));
    EXPECT_EQ(requests_for(all[2], {}), (std::vector<Request>{{"motors", R"({"stop-all":[]})"}}));
}

TEST(ServiceProperties, Tone_IsANumberWithAUsualDurationAndAStop) {
    const auto all = properties_of(board_of("tone"), standard);
    EXPECT_THAT(seen(all), ElementsAre("tone/frequency number 'Tone frequency' Hz frequency",
                                       "tone/stop button 'Tone stop'"));
    EXPECT_EQ(requests_for(all[0], 440), (std::vector<Request>{{"tone", R"({"play":[440,500]})"}}));
    EXPECT_EQ(requests_for(all[1], {}), (std::vector<Request>{{"tone", R"({"play":[0,0]})"}}));
}

TEST(ServiceProperties, PixelsAreALight) {
    EXPECT_THAT(seen_of("pixels"),
                ElementsAre("pixels/light light 'Pixels' brightness", "-pixels/count sensor 'Pixels count'"));
    EXPECT_THAT(seen_of("neopixels"), ElementsAre("neopixels/0/light light 'Neopixels' brightness",
                                                  "-neopixels/0/show button 'Neopixels show'"));
}

TEST(ServiceProperties, Display_IsATextForEachLine) {
    const auto all = properties_of(board_of("lcd"), standard);
    EXPECT_THAT(seen(all), ElementsAre("lcd/clear button 'Lcd clear'", "lcd/0/text text 'Lcd 0 text'",
                                       "lcd/1/text text 'Lcd 1 text'", "lcd/2/text text 'Lcd 2 text'",
                                       "lcd/3/text text 'Lcd 3 text'", "lcd/4/text text 'Lcd 4 text'"));
    EXPECT_EQ(all[1].max_length, 21u);
}

TEST(ServiceProperties, EachStandardService_HasSome) {
    for (const auto& model : model::ModelSet::standard().all()) {
        if (model->name == "io") continue;  // its pins are shown
        EXPECT_FALSE(seen_of(model->name).empty()) << model->name;
    }
}

TEST(ServiceProperties, LabelOfAService_IsTheName) {
    auto board = board_of("servo");
    board.labels.services["servo"] = "left arm";
    EXPECT_EQ(properties_of(board, standard)[0].name, "left arm");
    board.pins.owners = "SS";
    EXPECT_EQ(properties_of(board, standard)[1].name, "left arm 1");
}

/// The properties of a model of one's own, as JSON, without any of the optional members.
std::vector<Property> of_own(const char* parts, std::optional<int> count = std::nullopt) {
    auto document = json::parse(parts);
    document.update({{"name", "own"}, {"version", 1}, {"id", "X"}, {"title", "Own"}});
    const auto made = model::service_model_from_json(document);
    if (!made) throw std::runtime_error(made.error());
    const auto model = std::make_shared<const model::ServiceModel>(*made);
    return properties_of(board_of("own", count), [&](const ServiceInfo&) { return model; });
}

TEST(OwnService, CommandsAreWhatTheirArgumentsSay) {
    const auto all = of_own(R"({"element":"fan","commands":{
      "power":{"tag":"W","args":[{"name":"fan","type":"integer","min":0,"max":1},
                                 {"name":"power","type":"integer","unit":"%","min":0,"max":100,"names":{"off":0,"full":100}}]},
      "mode":{"tag":"M","args":[{"name":"mode","type":"integer","names":{"eco":0,"normal":1,"turbo":2}}]},
      "swing":{"tag":"S","args":[{"name":"swing","type":"integer","names":{"on":0,"off":1}}]},
      "tint":{"tag":"T","args":[{"name":"tint","type":"color"}]},
      "beep":{"tag":"B"}}})");
    EXPECT_THAT(seen(all), ElementsAre("own/light light 'Own'", "own/beep button 'Own beep'",
                                       "own/mode select 'Own mode'", "own/0/power number 'Own 0 power' %",
                                       "own/1/power number 'Own 1 power' %", "own/swing switch 'Own swing'"));
    EXPECT_EQ(requests_for(property(all, "own/mode"), "turbo")[0].payload, R"({"mode":[2]})");
    EXPECT_EQ(requests_for(property(all, "own/swing"), true)[0].payload, R"({"swing":[0]})");
    EXPECT_TRUE(requests_for(property(all, "own/mode"), "fast").empty());
}

TEST(OwnService, EventThatShowsWhatWasSet_IsTheStateOfTheSwitch) {
    const auto all = of_own(R"({"element":"relay","elements":2,
      "events":{"e":{"name":"state","fields":[{"name":"closed","type":"integer","min":0,"max":1}]}},
      "commands":{"set":{"tag":"W","writes":"state","args":[
        {"name":"relay","type":"integer","min":0,"max":7},{"name":"closed","type":"integer","min":0,"max":1}]}}})");
    EXPECT_THAT(seen(all),
                ElementsAre("own/0/closed switch 'Own 0 closed'", "own/1/closed switch 'Own 1 closed'"));
    EXPECT_EQ(value_in(all[1], json::parse(R"({"state":[0,1]})")), json(true));
}

TEST(OwnService, WithoutAModel_HasNoEntities) {
    EXPECT_TRUE(properties_of(board_of("nothing"), standard).empty());
}

TEST(ServiceProperties, TheirNumber_IsBounded) {
    Description board;
    for (int i = 0; i < 64; ++i) {
        ServiceInfo info;
        info.name = "d" + std::to_string(i);
        info.count = 65535;
        board.services.push_back(info);
    }
    EXPECT_EQ(
        properties_of(board, [](const ServiceInfo&) { return model::ModelSet::standard().find("distance"); })
            .size(),
        kMaxProperties);
}

}  // namespace
}  // namespace asip::property::test
