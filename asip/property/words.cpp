// SPDX-License-Identifier: Apache-2.0
#include "asip/property/words.hpp"

#include <cstdio>

#include "asip/model/json.hpp"

namespace asip::property {
namespace {

struct Words {
    std::string_view klass, on, off;
};
constexpr Words kWords[] = {{"button", "pressed", "released"},  {"door", "open", "closed"},
                            {"window", "open", "closed"},       {"motion", "detected", "clear"},
                            {"occupancy", "detected", "clear"}, {"smoke", "detected", "clear"},
                            {"vibration", "detected", "clear"}, {"moisture", "wet", "dry"}};

std::string truth_text(const Property& property, bool on) {
    for (const auto& words : kWords)
        if (words.klass == property.meaning.klass) return std::string(on ? words.on : words.off);
    return on ? "on" : "off";
}

std::string light_text(const nlohmann::json& value) {
    if (!value.value("on", false)) return "off";
    std::string text = "on";
    if (const auto found = value.find("brightness"); found != value.end() && found->is_number())
        text += ", " + std::to_string(found->get<int>()) + " of 255";
    if (const auto found = value.find("color"); found != value.end() && found->is_number_integer()) {
        char color[16];
        std::snprintf(color, sizeof color, "%06x", static_cast<unsigned>(found->get<int>()) & 0xffffffU);
        text += ", #" + std::string(color);
    }
    return text;
}

}  // namespace

std::string value_text(const Property& property, const nlohmann::json& value, bool raw) {
    if (value.is_null()) return "none";
    if (value.is_boolean()) return truth_text(property, value.get<bool>());
    if (value.is_object()) return light_text(value);
    if (value.is_string()) return value.get<std::string>();
    auto text = model::dump_json(value);
    if (!raw && !property.unit.empty()) text += (property.unit == "%" ? "" : " ") + property.unit;
    return text;
}

std::string unknown_text(Unknown why) {
    switch (why) {
        case Unknown::kRestart:
            return "unknown: nothing was reported or set since the board came back";
        case Unknown::kDoubt:
            return "unknown: a command may or may not have been executed";
        case Unknown::kNever:
            break;
    }
    return "unknown: nothing was reported or set yet";
}

std::vector<std::size_t> properties_named(const std::vector<Property>& properties, std::string_view id) {
    std::vector<std::size_t> below;
    for (std::size_t i = 0; i < properties.size(); ++i) {
        const std::string_view each = properties[i].id;
        if (each == id) return {i};
        if (each.starts_with(id) && each.size() > id.size() && each[id.size()] == '/') below.push_back(i);
    }
    return below;
}

}  // namespace asip::property
