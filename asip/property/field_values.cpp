// SPDX-License-Identifier: Apache-2.0
#include "asip/property/service_properties.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace asip::property {

using model::Field;
using model::FieldHints;
using model::ValueType;

bool is_number(const Field& field) {
    return field.type == ValueType::kInteger || field.type == ValueType::kNumber;
}

std::vector<std::pair<std::string, double>> named_numbers(const Field& field) {
    std::vector<std::pair<std::string, double>> result;
    for (const auto& [word, value] : field.names) {
        const auto number = static_cast<double>(value);
        const bool there = std::any_of(result.begin(), result.end(),
                                       [&](const auto& each) { return each.second == number; });
        if (!there) result.emplace_back(word, number);
    }
    return result;
}

std::vector<std::pair<std::string, double>> two_values(const Field& field, const FieldHints& hints) {
    std::vector<double> values;
    for (const auto& [word, value] : named_numbers(field))
        values.push_back(value);
    if (values.empty() && field.type == ValueType::kInteger && field.min && field.max &&
        *field.max == *field.min + 1)
        values = {*field.min, *field.max};
    if (values.size() != 2) return {};
    double on = std::max(values[0], values[1]);
    for (const auto& [word, value] : field.names)
        if (word == "on") on = static_cast<double>(value);
    if (hints.on &&
        (static_cast<double>(*hints.on) == values[0] || static_cast<double>(*hints.on) == values[1]))
        on = static_cast<double>(*hints.on);
    return {{"off", values[0] == on ? values[1] : values[0]}, {"on", on}};
}

bool names_say_all(const Field& field) {
    const auto count = static_cast<double>(named_numbers(field).size());
    if (count < 2) return false;
    return !field.min || !field.max || *field.max - *field.min + 1 == count;
}

void describe_number(Property& property, const Field& field, const FieldHints& hints) {
    property.unit = field.unit;
    property.quantity = hints.quantity;
    property.whole = field.type == ValueType::kInteger;
    property.min = field.min;
    property.max = field.max;
    property.step = hints.step;
    property.none = hints.none;
}

void make_settable(Property& property, const Field& argument, const FieldHints& hints) {
    property.choices = two_values(argument, hints);
    if (!property.choices.empty() && (argument.names.empty() || names_say_all(argument))) {
        property.kind = Kind::kSwitch;
    } else if (names_say_all(argument)) {
        property.kind = Kind::kSelect;
        property.choices = named_numbers(argument);
    } else {
        property.kind = Kind::kNumber;
        property.choices.clear();
    }
}

std::optional<Call> stop_call(const std::string& service, const model::ServiceModel& model) {
    if (model.safe.size() != 1 || model.safe[0].size() < 3) return std::nullopt;
    const auto& line = model.safe[0];
    const auto* command = model.command_with_tag(line[2]);
    if (command == nullptr) return std::nullopt;
    Call call{service, command->name, {}};
    for (std::size_t at = line.find(',', 2); at != std::string::npos; at = line.find(',', at + 1)) {
        char* end = nullptr;
        const double value = std::strtod(line.c_str() + at + 1, &end);
        if (end == line.c_str() + at + 1) return std::nullopt;
        call.arguments.emplace_back(value);
    }
    if (call.arguments.size() != model::given_arguments(*command).size()) return std::nullopt;
    return call;
}

std::string words_of(std::string_view name) {
    std::string text(name);
    std::replace_if(text.begin(), text.end(), [](char c) { return c == '-' || c == '_' || c == '.'; }, ' ');
    return text;
}

std::string capital(std::string text) {
    if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    return text;
}

}  // namespace asip::property
