// SPDX-License-Identifier: Apache-2.0
#include "asip/model/argument_writer.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/protocol/body.hpp"
#include "asip/protocol/limits.hpp"
#include "asip/text/nearest.hpp"

namespace asip::model {
namespace {

using nlohmann::json;
using Text = Expected<std::string>;

constexpr double kLargestExact = 9007199254740992.0;  // 2^53

std::string shown(const json& value) {
    const auto text = dump_json(value);
    return text.size() > 40 ? text.substr(0, 40) + "..." : text;
}

/// A number as people write it: no exponent, no needless zeros.
std::string number_text(double number) {
    if (std::abs(number) <= kLargestExact && std::floor(number) == number)
        return std::to_string(static_cast<std::int64_t>(number));
    std::array<char, 64> buffer{};
    const auto written =
        std::to_chars(buffer.data(), buffer.data() + buffer.size(), number, std::chars_format::fixed);
    return written.ec == std::errc{} ? std::string(buffer.data(), written.ptr) : std::string("0");
}

std::optional<double> number_from_text(std::string_view text) {
    double number = 0;
    const auto [end, fault] =
        std::from_chars(text.data(), text.data() + text.size(), number, std::chars_format::fixed);
    if (fault != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return number;
}

std::optional<double> number_from_name(const Field& field, const std::string& word) {
    for (const auto& [name, number] : field.names)
        if (name == word) return static_cast<double>(number);
    return std::nullopt;
}

std::optional<double> number_from_color(const std::string& text) {
    if (text.size() != 7 || text.front() != '#') return std::nullopt;
    const auto color = protocol::parse_hex(std::string_view(text).substr(1));
    if (!color) return std::nullopt;
    return static_cast<double>(*color);
}

std::string wrong_kind(const Field& field, const json& value) {
    if (field.type == ValueType::kColor) return shown(value) + " is not a color: a number or \"#rrggbb\"";
    if (field.type == ValueType::kNumber) return shown(value) + " is not a number";
    if (field.names.empty() || !value.is_string()) return shown(value) + " is not an integer";
    std::vector<std::string> names;
    for (const auto& [name, number] : field.names)
        names.push_back(name);
    const auto near = text::nearest(value.get_ref<const std::string&>(), names);
    return shown(value) + " is neither an integer nor a name" +
           (!near ? "" : "; did you mean \"" + *near + "\"?");
}

Text write_number(const Field& field, const json& value, Strictness strictness, const std::string& place) {
    const auto number = number_of(field, value, strictness);
    if (!number || !std::isfinite(*number)) return fail(place + ": " + wrong_kind(field, value));
    const bool whole = field.type != ValueType::kNumber;
    if (whole && std::abs(*number) <= kLargestExact && std::floor(*number) != *number)
        return fail(place + ": " + number_text(*number) + " is not an integer");
    const double min = field.min.value_or(std::numeric_limits<std::int32_t>::min());
    const double max = field.max.value_or(std::numeric_limits<std::int32_t>::max());
    if (*number < min || *number > max) {
        const auto given = std::abs(*number) <= kLargestExact ? number_text(*number) : shown(value);
        return fail(place + ": " + given +
                    (*number < min ? " is below " + number_text(min) : " is above " + number_text(max)));
    }
    return number_text(*number);
}

Text write_text(const Field& field, const json& value, Strictness strictness, const std::string& place) {
    if (!value.is_string() && (strictness == Strictness::kStrict || !value.is_number()))
        return fail(place + ": " + shown(value) + " is not a string");
    const auto text = value.is_string() ? value.get<std::string>() : dump_json(value);
    const bool printable =
        std::all_of(text.begin(), text.end(), [](char c) { return c >= 0x20 && c <= 0x7e; });
    if (!printable) return fail(place + ": holds characters that are not printable ASCII");
    if (field.max_length && text.size() > *field.max_length) {
        return fail(place + ": " + std::to_string(text.size()) + " characters are more than " +
                    std::to_string(*field.max_length));
    }
    return text;
}

/// The fields of one list item as an array of values.
Expected<json> item_values(const Field& list, const json& item, Strictness strictness,
                           const std::string& place) {
    std::string form;
    for (const auto& field : list.items)
        form += (form.empty() ? "" : ":") + field.name;
    json values = json::array();
    if (item.is_object()) {
        for (const auto& field : list.items) {
            const auto found = item.find(field.name);
            if (found == item.end()) return fail(place + ": '" + field.name + "' is missing");
            values.push_back(*found);
        }
        if (item.size() != list.items.size()) return fail(place + ": not an item of " + form);
    } else if (item.is_array()) {
        values = item;
    } else if (item.is_string() && (list.items.size() > 1 || strictness == Strictness::kLenient)) {
        for (const auto part : protocol::split_fields(item.get_ref<const std::string&>()))
            values.push_back(std::string(part));
    } else {
        values.push_back(item);
    }
    if (values.size() != list.items.size()) return fail(place + ": not an item of " + form);
    return values;
}

Text write_item(const Field& list, const json& item, Strictness strictness, const std::string& place) {
    const auto values = item_values(list, item, strictness, place);
    if (!values) return fail(values.error());
    // Text "0:255" carries its numbers as text, whatever stands around it.
    const auto inner = item.is_string() && list.items.size() > 1 ? Strictness::kLenient : strictness;
    std::string text;
    for (std::size_t i = 0; i < list.items.size(); ++i) {
        const auto& field = list.items[i];
        auto value =
            write_value(field, (*values)[i], inner, list.items.size() > 1 ? place + "/" + field.name : place);
        if (!value) return value;
        if (i > 0) text += ':';
        text += *value;
    }
    return text;
}

Text write_list(const Field& list, const json& value, Strictness strictness, const std::string& place) {
    if (!value.is_array()) return fail(place + ": " + shown(value) + " is not a list");
    if (value.empty()) return fail(place + ": the list is empty");
    // Each item takes at least a digit and a comma, so a longer list could not be sent either.
    const auto most = list.max_length.value_or(protocol::kMaxRequestBytes / 2);
    if (value.size() > most) {
        return fail(place + ": " + std::to_string(value.size()) + " items are more than " +
                    std::to_string(most));
    }
    std::string text = list.braces ? "{" : "";
    for (std::size_t i = 0; i < value.size(); ++i) {
        auto item = write_item(list, value[i], strictness, place + "/" + std::to_string(i));
        if (!item) return item;
        if (i > 0) text += ',';
        text += *item;
    }
    if (list.braces) text += '}';
    return text;
}

/// Where the list stands among the values, which leave counts out.
std::size_t value_index(const CommandModel& command, const std::string& name) {
    std::size_t index = 0;
    for (const auto& argument : command.args) {
        if (argument.name == name) break;
        if (argument.type != ValueType::kCount) ++index;
    }
    return index;
}

}  // namespace

std::optional<double> number_of(const Field& field, const json& value, Strictness strictness) {
    if (value.is_number()) return value.get<double>();
    if (value.is_boolean()) return value.get<bool>() ? 1 : 0;
    if (!value.is_string()) return std::nullopt;
    const auto& word = value.get_ref<const std::string&>();
    if (const auto named = number_from_name(field, word)) return named;
    if (field.type == ValueType::kColor) {
        if (const auto color = number_from_color(word)) return color;
    }
    return strictness == Strictness::kLenient ? number_from_text(word) : std::nullopt;
}

Text write_value(const Field& field, const json& value, Strictness strictness, const std::string& place) {
    if (field.type == ValueType::kList) return write_list(field, value, strictness, place);
    if (field.type == ValueType::kText) return write_text(field, value, strictness, place);
    return write_number(field, value, strictness, place);
}

Text write_arguments(const CommandModel& command, const json& values, Strictness strictness) {
    std::string text;
    std::size_t next = 0;
    for (const auto& argument : command.args) {
        text += ',';
        if (argument.type == ValueType::kCount) {
            text += std::to_string(values[value_index(command, argument.of)].size());
            continue;
        }
        auto value = write_value(argument, values[next++], strictness, argument.name);
        if (!value) return value;
        text += *value;
    }
    return text;
}

}  // namespace asip::model
