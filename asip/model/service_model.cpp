// SPDX-License-Identifier: Apache-2.0
#include "asip/model/service_model.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <set>

#include "asip/model/command_encoder.hpp"

namespace asip::model {

namespace {

// A shorter word ("IO") would be found inside too many names; it must be the whole name.
constexpr std::size_t kMinContainedBytes = 3;

std::string letters_and_digits(std::string_view text) {
    std::string result;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (std::isalnum(byte)) result += static_cast<char>(std::tolower(byte));
    }
    return result;
}

template <class List, class Test>
auto find_or_null(const List& list, Test test) -> const typename List::value_type* {
    const auto found = std::find_if(list.begin(), list.end(), test);
    return found == list.end() ? nullptr : &*found;
}

// Models may name limits that no integer holds.
std::string number(double value) {
    constexpr double kWhole = 9007199254740992.0;
    if (std::abs(value) > kWhole) return nlohmann::json(value).dump();
    return nlohmann::json(static_cast<std::int64_t>(value)).dump();
}

}  // namespace

std::string_view to_text(ValueType type) {
    static constexpr std::array<std::string_view, 6> kWords{"integer", "number", "text",
                                                            "color",   "count",  "list"};
    return kWords.at(static_cast<std::size_t>(type));
}

std::string ServiceModel::ref() const {
    return name + "@" + std::to_string(version);
}

std::vector<const Field*> given_arguments(const CommandModel& command) {
    std::vector<const Field*> result;
    result.reserve(command.args.size());
    for (const auto& argument : command.args)
        if (argument.type != ValueType::kCount) result.push_back(&argument);
    return result;
}

const EventModel* ServiceModel::event(char tag) const {
    return find_or_null(events, [&](const EventModel& event) { return event.tag == tag; });
}

const EventModel* ServiceModel::event_named(std::string_view event_name) const {
    return find_or_null(events, [&](const EventModel& event) { return event.name == event_name; });
}

const CommandModel* ServiceModel::command(std::string_view command_name) const {
    return find_or_null(commands, [&](const CommandModel& command) { return command.name == command_name; });
}

const CommandModel* ServiceModel::command_with_tag(char tag) const {
    return find_or_null(commands, [&](const CommandModel& command) { return command.tag == tag; });
}

bool ServiceModel::matches(char letter, std::string_view friendly_name) const {
    if (letter != id) return false;
    const auto given = letters_and_digits(friendly_name);
    if (given.empty()) return true;
    if (given == letters_and_digits(name)) return true;
    return std::any_of(match.begin(), match.end(), [&](const std::string& word) {
        const auto known = letters_and_digits(word);
        return known.size() < kMinContainedBytes ? given == known : given.find(known) != std::string::npos;
    });
}

std::vector<std::string> units_of(const ServiceModel& model) {
    std::set<std::string> units;
    const auto add = [&units](const std::vector<Field>& fields) {
        for (const auto& field : fields) {
            if (!field.unit.empty()) units.insert(field.unit);
            for (const auto& item : field.items)
                if (!item.unit.empty()) units.insert(item.unit);
        }
    };
    for (const auto& event : model.events)
        add(event.fields);
    for (const auto& command : model.commands)
        add(command.args);
    return {units.begin(), units.end()};
}

std::string describe(const Field& field) {
    if (field.type == ValueType::kList) {
        std::string items;
        for (const auto& item : field.items)
            items += (items.empty() ? "" : ":") + describe(item);
        return field.name + " (" + items + ")...";
    }
    std::string text = field.name;
    if (field.type == ValueType::kColor) return text + " (number or #rrggbb)";
    if (field.type == ValueType::kText)
        return field.max_length ? text + " up to " + std::to_string(*field.max_length) + " characters" : text;
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
