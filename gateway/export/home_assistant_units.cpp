// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "asip/model/object_text.hpp"
#include "gateway/export/home_assistant.hpp"

namespace asip::gateway::exports {
namespace {

struct UnitName {
    std::string_view quantity, ours, theirs;  // without a quantity: of any
};

constexpr std::array<UnitName, 8> kUnits{{
    {"temperature", "C",
     "\xc2\xb0"
     "C"},
    {"temperature", "F",
     "\xc2\xb0"
     "F"},
    {"", "degrees", "\xc2\xb0"},
    {"", "us", "\xce\xbcs"},
    {"", "uV", "\xce\xbcV"},
    {"", "uA",
     "\xce\xbc"
     "A"},
    {"volume", "l", "L"},
    {"volume", "ml", "mL"},
}};

struct Class {
    std::string_view quantity, device_class, units;  // separated by spaces, one at each end
};

/// Home Assistant refuses an property whose unit its class does not have; a unit without a class is always
/// taken. A class is named only for units that every version from 2024.11 on takes.
constexpr std::array<Class, 17> kClasses{{
    {"battery", "battery", " % "},
    {"carbon-dioxide", "carbon_dioxide", " ppm "},
    {"current", "current", " A mA "},
    {"distance", "distance", " km m cm mm mi yd in "},
    {"duration", "duration", " d h min s ms "},
    {"energy", "energy", " Wh kWh MWh MJ GJ "},
    {"frequency", "frequency", " Hz kHz MHz GHz "},
    {"humidity", "humidity", " % "},
    {"illuminance", "illuminance", " lx "},
    {"moisture", "moisture", " % "},
    {"power", "power", " W kW "},
    {"pressure", "pressure", " Pa hPa kPa bar mbar psi mmHg inHg "},
    {"speed", "speed", " m/s km/h mph ft/s "},
    {"temperature", "temperature",
     " \xc2\xb0"
     "C \xc2\xb0"
     "F K "},
    {"voltage", "voltage", " V mV "},
    {"volume", "volume_storage", " L mL "},
    {"weight", "weight", " kg g mg oz lb "},
}};

std::string usual_icon(std::string_view klass) {
    constexpr std::pair<std::string_view, const char*> kIcons[] = {{"button", "mdi:gesture-tap-button"},
                                                                   {"relay", "mdi:electric-switch"},
                                                                   {"fan", "mdi:fan"},
                                                                   {"pump", "mdi:pump"},
                                                                   {"heater", "mdi:radiator"},
                                                                   {"buzzer", "mdi:bullhorn"}};
    for (const auto& [word, icon] : kIcons)
        if (word == klass) return icon;
    return {};
}

}  // namespace

DeviceClass device_class_of(std::string_view quantity, std::string_view unit) {
    DeviceClass result{std::string(unit), {}};
    for (const auto& each : kUnits)
        if (each.ours == unit && (each.quantity.empty() || each.quantity == quantity))
            result.unit = each.theirs;
    for (const auto& each : kClasses)
        if (each.quantity == quantity && !result.unit.empty() &&
            each.units.find(" " + result.unit + " ") != std::string_view::npos)
            result.device_class = each.device_class;
    return result;
}

std::string_view quantity_of(const Property& property) {
    const auto& klass = property.meaning.klass;
    return model::use_of_class(klass) == model::ClassUse::kNumber ? klass : property.quantity;
}

void describe_class(ObjectText& component, std::string_view platform, const model::Meaning& meaning) {
    const auto& klass = meaning.klass;
    if (platform == "binary_sensor" && klass != "button" &&
        model::use_of_class(klass) == model::ClassUse::kInput)
        component.add("dev_cla", klass);
    if (platform == "switch" && klass == "plug") component.add("dev_cla", "outlet");
    const auto icon = meaning.icon.empty() ? usual_icon(klass) : meaning.icon;
    if (!icon.empty()) component.add("ic", icon);
}

void describe_unit(ObjectText& component, const Property& property) {
    const auto shown = device_class_of(quantity_of(property), property.unit);
    if (!shown.unit.empty()) component.add("unit_of_meas", shown.unit);
    if (!shown.device_class.empty()) component.add("dev_cla", shown.device_class);
}

}  // namespace asip::gateway::exports
