// SPDX-License-Identifier: Apache-2.0
// What the oldest promised Home Assistant takes, 2024.11.0: facts of its components `mqtt` (keys of each
// platform), `sensor`, `number`, `binary_sensor` and `switch` (classes, units, state classes). What is not in
// it makes that version refuse the whole entity, or is passed over.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "asip/model/model_set.hpp"
#include "board_of_all.hpp"
#include "export_world.hpp"
#include "gateway/export/home_assistant.hpp"
#include "tests/support/words.hpp"

namespace asip::gateway::exports {
namespace {

using nlohmann::json;
using Words = std::set<std::string>;

const Words kOfAll{"p", "uniq_id", "name", "stat_t", "ent_cat", "en", "ic"};
// Newer; passed over by 2024.11.
const Words kNewer{"def_ent_id"};
const std::map<std::string, Words> kKeys{
    {"sensor", {"dev_cla", "stat_cla", "unit_of_meas", "ops"}},
    {"binary_sensor", {"dev_cla"}},
    {"event", {"dev_cla", "evt_typ"}},
    {"number", {"cmd_t", "min", "max", "step", "unit_of_meas", "dev_cla"}},
    {"switch", {"cmd_t", "dev_cla"}},
    {"select", {"cmd_t", "ops"}},
    {"text", {"cmd_t", "max", "pattern"}},
    {"button", {"cmd_t"}},
    {"update", {"dev_cla"}},
    {"light", {"cmd_t", "schema", "sup_clrm", "brightness"}},
};

const Words kMeasured{"measurement"};
const Words kEachState{"measurement", "total", "total_increasing"};
struct SensorClass {
    Words units, states;
};
const std::map<std::string, SensorClass> kSensorClasses{
    {"battery", {{"%"}, kMeasured}},
    {"carbon_dioxide", {{"ppm"}, kMeasured}},
    {"current", {{"mA", "A"}, kMeasured}},
    {"distance", {{"mm", "cm", "m", "km", "in", "ft", "yd", "mi", "nmi"}, kEachState}},
    {"duration", {{"d", "h", "min", "s", "ms"}, kEachState}},
    {"energy",
     {{"J", "kJ", "MJ", "GJ", "Wh", "kWh", "MWh", "cal", "kcal", "Mcal", "Gcal"},
      {"total", "total_increasing"}}},
    {"enum", {{}, {}}},
    {"frequency", {{"Hz", "kHz", "MHz", "GHz"}, kMeasured}},
    {"humidity", {{"%"}, kMeasured}},
    {"illuminance", {{"lx"}, kMeasured}},
    {"moisture", {{"%"}, kMeasured}},
    {"power", {{"W", "kW"}, kMeasured}},
    {"pressure", {{"Pa", "hPa", "kPa", "bar", "cbar", "mbar", "mmHg", "inHg", "psi"}, kMeasured}},
    {"speed",
     {{"Beaufort", "ft/s", "in/s", "m/s", "km/h", "kn", "mph", "mm/s", "in/d", "in/h", "mm/d", "mm/h"},
      kMeasured}},
    {"temperature", {{"\u00b0C", "\u00b0F", "K"}, kMeasured}},
    {"voltage", {{"mV", "V"}, kMeasured}},
    {"volume_storage", {{"ft\u00b3", "CCF", "m\u00b3", "L", "mL", "gal", "fl. oz."}, kMeasured}},
    {"weight", {{"g", "kg", "mg", "\u00b5g", "oz", "lb", "st"}, kMeasured}},
};
const auto kInputs = test::words(
    "battery battery_charging carbon_monoxide cold connectivity door gas garage_door heat light "
    "lock moisture motion moving occupancy opening plug power presence problem running safety "
    "smoke sound tamper update vibration window");

std::string text_of(const json& component, const char* key) {
    return component.value(key, std::string());
}

void expect_class(const json& component, const std::string& platform) {
    const auto klass = text_of(component, "dev_cla");
    const auto state = text_of(component, "stat_cla");
    if (!state.empty()) {
        EXPECT_TRUE(kEachState.contains(state));
    }
    if (klass.empty()) return;
    if (platform == "binary_sensor") {
        EXPECT_THAT(kInputs, testing::Contains(klass));
    } else if (platform == "event") {
        EXPECT_TRUE(Words({"button", "doorbell", "motion"}).contains(klass));
    } else if (platform == "update") {
        EXPECT_EQ(klass, "firmware");
    } else if (platform == "switch") {
        EXPECT_TRUE(klass == "outlet" || klass == "switch");
    } else {
        ASSERT_TRUE(kSensorClasses.contains(klass));
        const auto& known = kSensorClasses.at(klass);
        const auto unit = text_of(component, "unit_of_meas");
        EXPECT_TRUE(known.units.contains(unit) || (unit.empty() && known.units.empty()));
        EXPECT_TRUE(state.empty() || known.states.contains(state));
    }
}

void expect_taken(const json& component) {
    SCOPED_TRACE(component.dump());
    const auto platform = text_of(component, "p");
    ASSERT_TRUE(kKeys.contains(platform));
    for (const auto& [key, value] : component.items())
        EXPECT_TRUE(kOfAll.contains(key) || kNewer.contains(key) || kKeys.at(platform).contains(key)) << key;
    EXPECT_TRUE(component.contains("cmd_t") ||
                !Words({"number", "switch", "select", "text", "button", "light"}).contains(platform));
    EXPECT_TRUE(component.contains("stat_t") || platform != "sensor");
    if (const auto category = text_of(component, "ent_cat"); !category.empty()) {
        EXPECT_TRUE(category == "config" || category == "diagnostic");
    }
    if (platform == "sensor" && component.contains("ops")) {
        EXPECT_EQ(text_of(component, "dev_cla"), "enum");
        EXPECT_FALSE(component.contains("stat_cla") || component.contains("unit_of_meas"));
        EXPECT_FALSE(component["ops"].empty());
    }
    if (platform == "number") {
        EXPECT_LT(component["min"], component["max"]);
        EXPECT_GE(component["step"], 0.001);
    }
    if (platform == "text") {
        EXPECT_LE(component["max"], 255);
    }
    if (platform == "light") {
        EXPECT_EQ(component["schema"], "json");
        ASSERT_EQ(component["sup_clrm"].size(), 1u);
        EXPECT_TRUE(Words({"onoff", "brightness", "rgb"}).contains(component["sup_clrm"][0]));
    }
    expect_class(component, platform);
}

void expect_taken(const ExportedBoard& board) {
    for (const bool read_only : {false, true})
        for (const bool entity_ids : {false, true}) {
            HomeAssistant::Options options;
            options.read_only = read_only;
            options.entity_ids = entity_ids;
            options.page = "http://pi:8080/";
            options.version = "0.1.0";
            const auto document = json::parse(HomeAssistant(options).document(board));
            for (const auto& [key, value] : document.items())
                EXPECT_TRUE(Words({"dev", "o", "avty", "avty_mode", "cmps"}).contains(key)) << key;
            for (const auto& [key, value] : document["dev"].items())
                EXPECT_TRUE(Words({"ids", "name", "mf", "mdl", "sw", "sa", "cu"}).contains(key)) << key;
            for (const auto& [key, value] : document["o"].items())
                EXPECT_TRUE(Words({"name", "sw"}).contains(key)) << key;
            for (const auto& [id, component] : document["cmps"].items())
                expect_taken(component);
        }
}

TEST(HomeAssistantOf2024, TakesEachStandardService) {
    auto description = description_of_all();
    description.pins.analog.push_back({15, 1});
    int pin = 6;
    for (const auto* klass :
         {"door", "window", "motion", "occupancy", "moisture", "smoke", "vibration", "button", "plug", "fan"})
        description.labels.meanings["io/" + std::to_string(pin++)].klass = klass;
    ExportedBoard board;
    board.board = "uno1";
    board.chip = "ATmega328P";
    board.sketch = "AsipServices";
    board.version = "0.2";
    board.room = "lab";
    board.properties = property::properties_of(description, [](const model::ServiceInfo& service) {
        return model::ModelSet::standard().find(service.name);
    });
    ASSERT_GT(board.properties.size(), 40u);
    expect_taken(board);
}

TEST(HomeAssistantOf2024, TakesEachQuantityInEachUnit) {
    const Words units{"",        "%",   "ppm", "A",  "mA", "uA",  "km",  "m",    "cm",   "mm",   "mi",
                      "yd",      "in",  "ft",  "d",  "h",  "min", "s",   "ms",   "us",   "Wh",   "kWh",
                      "MWh",     "MJ",  "GJ",  "J",  "Hz", "kHz", "MHz", "GHz",  "lx",   "W",    "kW",
                      "mW",      "Pa",  "hPa", "C",  "F",  "K",   "kPa", "bar",  "mbar", "psi",  "mmHg",
                      "inHg",    "m/s", "V",   "mV", "uV", "l",   "ml",  "km/h", "mph",  "ft/s", "rad",
                      "degrees", "kg",  "g",   "mg", "oz", "lb"};
    ExportedBoard board;
    board.board = "uno1";
    for (const auto* quantity : {"", "angle", "battery", "carbon-dioxide", "current", "distance", "duration",
                                 "energy", "frequency", "humidity", "illuminance", "moisture", "power",
                                 "pressure", "speed", "temperature", "voltage", "volume", "weight"})
        for (const auto& unit : units)
            for (const auto kind : {Kind::kSensor, Kind::kNumber}) {
                Property property;
                property.id = "own/" + std::to_string(board.properties.size());
                property.service = "own";
                property.name = "N";
                property.kind = kind;
                property.quantity = quantity;
                property.unit = unit;
                property.read = property::Place{"own", "/x"};
                if (kind == Kind::kNumber) property.write = property::Call{"own", "set", {std::nullopt}};
                property.min = 0;
                property.max = 100;
                board.properties.push_back(std::move(property));
            }
    expect_taken(board);
}

}  // namespace
}  // namespace asip::gateway::exports
