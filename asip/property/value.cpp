// SPDX-License-Identifier: Apache-2.0
#include "asip/property/value.hpp"

#include <algorithm>
#include <cmath>

#include "asip/model/json.hpp"

namespace asip::property {
namespace {

using nlohmann::json;

constexpr double kRounding = 1e6;  // of what a straight line gives: six digits behind the point

bool is_within(const Property& property, double value) {
    return std::isfinite(value) && (!property.min || value >= *property.min) &&
           (!property.max || value <= *property.max);
}

std::optional<json> value_of_number(const Property& property, double raw) {
    const auto choice = std::find_if(property.choices.begin(), property.choices.end(),
                                     [&](const auto& each) { return each.second == raw; });
    const bool known = choice != property.choices.end();
    switch (property.kind) {
        case Kind::kSwitch:
        case Kind::kBinarySensor:
            return known ? std::optional<json>(choice->first == "on") : std::nullopt;
        case Kind::kSelect:
            return known ? std::optional<json>(choice->first) : std::nullopt;
        case Kind::kSensor:
            if (!property.choices.empty()) return known ? std::optional<json>(choice->first) : std::nullopt;
            break;
        default:
            break;
    }
    const bool bent = property.meaning.line && property.kind == Kind::kSensor;
    const double value = bent ? on_line(*property.meaning.line, raw) : raw;
    return is_within(property, value) ? std::optional<json>(json_number(value)) : std::nullopt;
}

/// The number of a word; nothing: it is none of them.
std::optional<double> number_of(const Property& property, std::string_view word) {
    for (const auto& [name, number] : property.choices)
        if (name == word) return number;
    return std::nullopt;
}

std::optional<double> raw_of(const Property& property, const json& value) {
    if (property.kind == Kind::kNumber) {
        if (!value.is_number()) return std::nullopt;
        const auto wanted = value.get<double>();
        if (!is_within(property, wanted) || (property.whole && std::floor(wanted) != wanted))
            return std::nullopt;
        return wanted;
    }
    std::string word;
    if (property.kind == Kind::kSwitch && value.is_boolean()) word = value.get<bool>() ? "on" : "off";
    if (property.kind == Kind::kSelect && value.is_string()) word = value.get<std::string>();
    return number_of(property, word);
}

Request request_of(const Call& call, const json& value) {
    json arguments = json::array();
    for (const auto& argument : call.arguments)
        arguments.push_back(argument ? json_number(*argument) : value);
    return {call.service, model::dump_json(json{{call.command, std::move(arguments)}})};
}

/// Nothing: the member is there, and is no number from 0 to `max`.
bool number_within(const json& value, const char* member, double max) {
    const auto found = value.find(member);
    if (found == value.end()) return true;
    return found->is_number() && found->get<double>() >= 0 && found->get<double>() <= max;
}

std::vector<Request> light_requests(const Property& property, const json& value) {
    std::vector<Request> result;
    if (!is_light_value(value)) return result;
    const bool on = value["on"].get<bool>();
    if (property.color && (!on || value.contains("color") || !property.write)) {
        const bool only_color = !property.write;
        if (on || only_color)
            result.push_back(
                request_of(*property.color, on ? value.value("color", json(0xffffff)) : json(0)));
    }
    if (const auto raw = number_of(property, on ? "on" : "off"); property.write && raw) {
        result.push_back(request_of(*property.write, json_number(*raw)));
    } else if (property.write) {
        const double brightness = on ? value.value("brightness", kFullBrightness) : 0;
        const double level = brightness * property.max.value_or(kFullBrightness) / kFullBrightness;
        // What is on stays on: the lowest level of a board may be above the lowest of another system.
        result.push_back(
            request_of(*property.write, json_number(brightness > 0 ? std::max(std::round(level), 1.0) : 0)));
    }
    return result;
}

/// The number of an element; a key that is none is beyond any array.
std::size_t index_of(std::string_view key) {
    constexpr std::size_t kMost = 5, kNone = static_cast<std::size_t>(-1);
    if (key.empty() || key.size() > kMost) return kNone;
    std::size_t index = 0;
    for (const char c : key) {
        if (c < '0' || c > '9') return kNone;
        index = index * 10 + static_cast<std::size_t>(c - '0');
    }
    return index;
}

}  // namespace

bool is_light_value(const json& value) {
    return value.is_object() && value.contains("on") && value["on"].is_boolean() &&
           number_within(value, "brightness", kFullBrightness) && number_within(value, "color", kMaxColor);
}

double on_line(const std::array<double, 4>& line, double raw) {
    const double value = line[2] + (raw - line[0]) * (line[3] - line[2]) / (line[1] - line[0]);
    return std::round(value * kRounding) / kRounding;
}

bool has_value(const Property& property, const json& raw) {
    const bool plain = (property.kind == Kind::kSensor || property.kind == Kind::kNumber) &&
                       property.choices.empty() && property.max_length == 0 && !property.meaning.line;
    if (!plain || !raw.is_number()) return value_of(property, raw).has_value();
    const auto number = raw.get<double>();
    return property.none == number || is_within(property, number);
}

std::optional<json> value_of(const Property& property, const json& raw) {
    if (raw.is_null()) return json();
    if (property.kind == Kind::kLight) return std::nullopt;  // of two raw values: light_of()
    if (property.max_length > 0)
        return raw.is_string() && raw.get_ref<const std::string&>().size() <= property.max_length
                   ? std::optional(raw)
                   : std::nullopt;
    if (!raw.is_number()) return std::nullopt;
    const auto number = raw.get<double>();
    if (property.none == number) return json();
    return value_of_number(property, number);
}

const json* raw_in(const Place& place, const json& published) {
    const json* at = &published;
    std::string_view rest(place.pointer);
    while (!rest.empty()) {
        rest.remove_prefix(1);
        const auto end = std::min(rest.find('/'), rest.size());
        const auto key = rest.substr(0, end);
        rest.remove_prefix(end);
        if (const auto* object = at->get_ptr<const json::object_t*>()) {
            const auto found = object->find(key);
            if (found == object->end()) return nullptr;
            at = &found->second;
        } else if (const auto* array = at->get_ptr<const json::array_t*>()) {
            const auto index = index_of(key);
            if (index >= array->size()) return nullptr;
            at = &(*array)[index];
        } else {
            return nullptr;
        }
    }
    return at;
}

std::optional<json> value_in(const Property& property, const json& published) {
    if (!property.read) return std::nullopt;
    const auto* raw = raw_in(*property.read, published);
    return raw == nullptr ? std::nullopt : value_of(property, *raw);
}

std::optional<json> light_of(const Property& property, std::optional<double> level,
                             std::optional<double> color) {
    if (property.write ? !level : !color) return std::nullopt;
    if (property.write && !property.choices.empty()) return json{{"on", level == number_of(property, "on")}};
    json value{{"on", property.write ? *level > 0 : *color > 0}};
    if (property.write && *level > 0)
        value["brightness"] =
            json_number(std::round(*level * kFullBrightness / property.max.value_or(kFullBrightness)));
    if (color && *color > 0) value["color"] = json_number(*color);
    return value;
}

json value_of_control(const Property& property, const json& wanted) {
    if (property.kind != Kind::kLight) return wanted;
    if (wanted.is_boolean()) return {{"on", wanted}};
    if (!wanted.is_number()) return wanted;
    if (wanted == 0) return {{"on", false}};
    return {{"on", true}, {"brightness", wanted}};
}

std::vector<Request> requests_for(const Property& property, const json& value) {
    std::vector<Request> result;
    if (property.before) result.push_back(request_of(*property.before, {}));
    if (property.kind == Kind::kLight) {
        auto more = light_requests(property, value);
        if (more.empty()) return {};
        result.insert(result.end(), more.begin(), more.end());
        return result;
    }
    if (!property.write) return {};
    if (property.kind == Kind::kButton) {
        result.push_back(request_of(*property.write, {}));
    } else if (property.kind == Kind::kText) {
        if (!value.is_string() || value.get_ref<const std::string&>().size() > property.max_length) return {};
        result.push_back(request_of(*property.write, value));
    } else {
        const auto wanted = raw_of(property, value);
        if (!wanted) return {};
        result.push_back(request_of(*property.write, json_number(*wanted)));
    }
    return result;
}

}  // namespace asip::property
