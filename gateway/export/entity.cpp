// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/entity.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"

namespace asip::gateway::exports {
namespace {

using nlohmann::json;

/// The word (or truth) that a number stands for.
std::optional<json> value_of_number(const Entity& entity, double value) {
    const auto option = std::find_if(entity.options.begin(), entity.options.end(),
                                     [&](const auto& each) { return each.second == value; });
    switch (entity.kind) {
        case EntityKind::kSwitch:
        case EntityKind::kBinarySensor:
            if (option == entity.options.end()) return std::nullopt;
            return option->first == "on";
        case EntityKind::kSelect:
            if (option == entity.options.end()) return std::nullopt;
            return option->first;
        case EntityKind::kSensor:
            if (option != entity.options.end()) return option->first;
            return json_number(value);
        default:
            return json_number(value);
    }
}

std::optional<double> number_of_value(const Entity& entity, const json& value) {
    if (entity.kind == EntityKind::kNumber) {
        if (!value.is_number()) return std::nullopt;
        const auto wanted = value.get<double>();
        if (!std::isfinite(wanted) || (entity.min && wanted < *entity.min) ||
            (entity.max && wanted > *entity.max) || (entity.whole && std::floor(wanted) != wanted))
            return std::nullopt;
        return wanted;
    }
    std::string word;
    if (entity.kind == EntityKind::kSwitch && value.is_boolean()) word = value.get<bool>() ? "on" : "off";
    if (entity.kind == EntityKind::kSelect && value.is_string()) word = value.get<std::string>();
    for (const auto& [name, each] : entity.options)
        if (name == word) return each;
    return std::nullopt;
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

std::vector<Request> light_requests(const Entity& entity, const json& value) {
    std::vector<Request> result;
    if (!value.is_object() || !value.contains("on") || !value["on"].is_boolean() ||
        !number_within(value, "brightness", kFullBrightness) || !number_within(value, "color", kMaxColor))
        return result;
    const bool on = value["on"].get<bool>();
    if (entity.color && (!on || value.contains("color") || !entity.write)) {
        const bool only_color = !entity.write;
        if (on || only_color)
            result.push_back(request_of(*entity.color, on ? value.value("color", json(0xffffff)) : json(0)));
    }
    if (entity.write) {
        const double brightness = on ? value.value("brightness", kFullBrightness) : 0;
        const double level = brightness * entity.max.value_or(kFullBrightness) / kFullBrightness;
        // What is on stays on: the lowest level of a board may be above the lowest of a dialect.
        result.push_back(
            request_of(*entity.write, json_number(brightness > 0 ? std::max(std::round(level), 1.0) : 0)));
    }
    return result;
}

/// The number (or text) that a call set; nothing: not known.
std::optional<json> value_of_call(const Call& call, const json& set) {
    if (!set.is_object()) return std::nullopt;
    const auto command = set.find(call.command);
    if (command == set.end()) return std::nullopt;
    const json* value = &*command;
    if (call.element) {
        if (call.arguments.empty() || !call.arguments[0] || !value->is_object()) return std::nullopt;
        const auto element = value->find(std::to_string(static_cast<int>(*call.arguments[0])));
        if (element == value->end()) return std::nullopt;
        value = &*element;
    }
    if (call.arguments.size() - (call.element ? 1 : 0) > 1) {
        const auto argument = value->find(call.name);
        if (argument == value->end()) return std::nullopt;
        value = &*argument;
    }
    return *value;
}

std::optional<double> number_of_call(const std::optional<Call>& call, const json& set) {
    if (!call) return std::nullopt;
    const auto value = value_of_call(*call, set);
    if (!value || !value->is_number()) return std::nullopt;
    return value->get<double>();
}

std::optional<json> light_set(const Entity& entity, const json& set) {
    const auto level = number_of_call(entity.write, set);
    const auto color = number_of_call(entity.color, set);
    if (entity.write ? !level : !color) return std::nullopt;
    json value{{"on", entity.write ? *level > 0 : *color > 0}};
    if (level && *level > 0)
        value["brightness"] =
            json_number(std::round(*level * kFullBrightness / entity.max.value_or(kFullBrightness)));
    if (color && *color > 0) value["color"] = json_number(*color);
    return value;
}

}  // namespace

json json_number(double value) {
    constexpr double kExact = 9e15;
    if (std::floor(value) == value && std::abs(value) < kExact) return static_cast<std::int64_t>(value);
    return value;
}

std::optional<json> value_in(const Entity& entity, const json& published) {
    if (!entity.read) return std::nullopt;
    const json::json_pointer pointer(entity.read->pointer);
    if (!published.contains(pointer)) return std::nullopt;
    const auto& found = published[pointer];
    if (found.is_null() || (found.is_string() && entity.kind == EntityKind::kSensor)) return found;
    if (!found.is_number()) return std::nullopt;
    return value_of_number(entity, found.get<double>());
}

std::vector<Request> requests_for(const Entity& entity, const json& value) {
    std::vector<Request> result;
    if (entity.before) result.push_back(request_of(*entity.before, {}));
    if (entity.kind == EntityKind::kLight) {
        auto more = light_requests(entity, value);
        if (more.empty()) return {};
        result.insert(result.end(), more.begin(), more.end());
        return result;
    }
    if (!entity.write) return {};
    if (entity.kind == EntityKind::kButton) {
        result.push_back(request_of(*entity.write, {}));
    } else if (entity.kind == EntityKind::kText) {
        if (!value.is_string() || value.get_ref<const std::string&>().size() > entity.max_length) return {};
        result.push_back(request_of(*entity.write, value));
    } else {
        const auto wanted = number_of_value(entity, value);
        if (!wanted) return {};
        result.push_back(request_of(*entity.write, json_number(*wanted)));
    }
    return result;
}

std::optional<json> value_set(const Entity& entity, const json& set) {
    if (entity.kind == EntityKind::kLight) return light_set(entity, set);
    if (!entity.write || entity.kind == EntityKind::kButton) return std::nullopt;
    const auto value = value_of_call(*entity.write, set);
    if (!value) return std::nullopt;
    if (entity.kind == EntityKind::kText) return value->is_string() ? value : std::nullopt;
    if (!value->is_number()) return std::nullopt;
    return value_of_number(entity, value->get<double>());
}

}  // namespace asip::gateway::exports
