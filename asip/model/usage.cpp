// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "asip/model/command_encoder.hpp"

namespace asip::model {
namespace {

// Models may name limits that no integer holds.
std::string number(double value) {
    constexpr double kWhole = 9007199254740992.0;
    if (std::abs(value) > kWhole) return nlohmann::json(value).dump();
    return nlohmann::json(static_cast<std::int64_t>(value)).dump();
}

}  // namespace

std::string describe(const Field& field) {
    if (field.type == ValueType::kList) {
        std::string items;
        for (const auto& item : field.items)
            items += (items.empty() ? "" : ":") + describe(item);
        return field.name + " (" + items + ")...";
    }
    std::string text = field.name;
    if (field.type == ValueType::kColor) return text + " (number or #rrggbb)";
    if (field.type == ValueType::kText) {
        return field.max_length ? text + " up to " + std::to_string(*field.max_length) + " characters" : text;
    }
    if (field.min && field.max) text += " " + number(*field.min) + ".." + number(*field.max);
    if (!field.unit.empty()) text += " " + field.unit;
    if (field.names.empty()) return text;
    std::string names;
    for (const auto& [name, value] : field.names)
        names += (names.empty() ? "" : "|") + name;
    return text + " (" + names + ")";
}

std::string usage(const CommandModel& command) {
    std::string text;
    for (const auto& argument : command.args) {
        if (argument.type == ValueType::kCount) continue;
        text += (text.empty() ? "" : ", ") + describe(argument);
    }
    return text;
}

std::string safe_usage(const ServiceModel& model, const CommandModel& command) {
    if (!command.safe) return {};
    const auto given = given_arguments(command);
    std::string text{model.id, ',', model.command(command.safe->command)->tag};
    for (const auto& argument : command.safe->arguments)
        text += "," + (argument.given ? given[*argument.given]->name : number(argument.number));
    return text;
}

}  // namespace asip::model
