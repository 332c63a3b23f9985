// SPDX-License-Identifier: Apache-2.0
#include "cli/text/set_text.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"

namespace asip::cli {
namespace {

using nlohmann::json;

std::string plain(const json& value) {
    return value.is_string() ? value.get<std::string>() : model::dump_json(value);
}

/// `field`: null where it is not known.
std::string value_text(const json& value, const model::Field* field) {
    if (field != nullptr && value.is_number_integer())
        for (const auto& [name, number] : field->names)
            if (number == value.get<std::int64_t>()) return name;
    const auto text = plain(value);
    return field == nullptr || field->unit.empty() ? text : text + " " + field->unit;
}

std::string values_text(const json& value, const model::CommandModel* command) {
    const auto args =
        command == nullptr ? std::vector<const model::Field*>() : model::given_arguments(*command);
    if (!value.is_object()) return value_text(value, args.empty() ? nullptr : args.back());
    std::string text;
    for (const auto& [name, member] : value.items()) {
        const auto field =
            std::find_if(args.begin(), args.end(), [&](const auto* each) { return each->name == name; });
        text += (text.empty() ? "" : " ") + name + " " +
                value_text(member, field == args.end() ? nullptr : *field);
    }
    return text;
}

/// Whether the members of `value` are elements, not the arguments of a command.
bool by_element(const json& value) {
    if (!value.is_object() || value.empty()) return false;
    return std::all_of(value.items().begin(), value.items().end(), [](const auto& item) {
        const auto& key = item.key();
        return !key.empty() &&
               std::all_of(key.begin(), key.end(), [](char c) { return c >= '0' && c <= '9'; });
    });
}

bool by_number(const SetItem& a, const SetItem& b) {
    return a.element.size() != b.element.size() ? a.element.size() < b.element.size() : a.element < b.element;
}

}  // namespace

std::vector<SetItem> set_items(const json& set, const model::ServiceModel* model) {
    std::vector<SetItem> items;
    if (!set.is_object()) return items;
    for (const auto& [name, value] : set.items()) {
        const auto* command = model == nullptr ? nullptr : model->command(name);
        if (!by_element(value)) {
            items.push_back({name, {}, values_text(value, command)});
            continue;
        }
        const auto first = static_cast<std::ptrdiff_t>(items.size());
        for (const auto& [element, member] : value.items())
            items.push_back({name, element, values_text(member, command)});
        std::sort(items.begin() + first, items.end(), by_number);
    }
    return items;
}

std::string set_text(const json& set, const model::ServiceModel* model) {
    std::string text;
    for (const auto& item : set_items(set, model))
        text += (text.empty() ? "" : ", ") + item.command + (item.element.empty() ? "" : " " + item.element) +
                (item.value == "true" ? "" : "=" + item.value);
    return text;
}

}  // namespace asip::cli
