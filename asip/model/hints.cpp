// SPDX-License-Identifier: Apache-2.0
#include "asip/model/hints.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/model/argument_writer.hpp"

namespace asip::model {
namespace {

using nlohmann::json;

FieldHints read_hints(const json& field) {
    FieldHints hints;
    hints.quantity = field.value("quantity", "");
    if (const auto step = field.find("step"); step != field.end()) hints.step = step->get<double>();
    if (const auto value = field.find("default"); value != field.end())
        hints.default_value = value->get<double>();
    if (const auto on = field.find("on"); on != field.end()) hints.on = on->get<std::int64_t>();
    if (const auto none = field.find("none"); none != field.end()) hints.none = none->get<double>();
    hints.advanced = field.value("advanced", false);
    hints.sum = field.value("sum", false);
    return hints;
}

std::string key_of(char kind, std::string_view owner, std::string_view name) {
    return std::string(1, kind) + "." + std::string(owner) + "." + std::string(name);
}

const Field* field_named(const std::vector<Field>& fields, std::string_view name) {
    const auto found =
        std::find_if(fields.begin(), fields.end(), [&](const Field& field) { return field.name == name; });
    return found == fields.end() ? nullptr : &*found;
}

ModelHints::Shown shown_from(std::string_view text) {
    const auto dot = text.find('.');
    if (dot == std::string_view::npos) return {std::string(text), {}};
    return {std::string(text.substr(0, dot)), std::string(text.substr(dot + 1))};
}

/// "0/power" -> element 0, name "power".
ModelHints::Sets sets_from(const std::string& key, const json& value) {
    ModelHints::Sets sets;
    const auto slash = key.find('/');
    if (slash != std::string::npos) sets.element = std::stoi(key.substr(0, slash));
    sets.name = slash == std::string::npos ? key : key.substr(slash + 1);
    if (value.is_string())
        sets.argument = value.get<std::string>();
    else if (value.is_number())
        sets.value = value.get<double>();
    return sets;
}

std::string sets_fault(const ServiceModel& model, const CommandModel& command, const ModelHints::Sets& sets) {
    const bool known = std::any_of(model.commands.begin(), model.commands.end(), [&](const auto& other) {
        return other.name != command.name && field_named(other.args, sets.name) != nullptr;
    });
    if (!known) return "no other command has an argument \"" + sets.name + "\"";
    if (!sets.argument.empty() && field_named(command.args, sets.argument) == nullptr)
        return "it has no argument \"" + sets.argument + "\"";
    return {};
}

/// An event that says a value of one field, by itself or for each element.
std::string shown_fault(const ServiceModel& model, const ModelHints::Shown& shown) {
    const auto* event = model.event_named(shown.event);
    if (event == nullptr) return "there is no event \"" + shown.event + "\"";
    if (shown.field.empty() && event->fields.size() != 1)
        return "event \"" + shown.event + "\" has several fields: write EVENT.FIELD";
    if (!shown.field.empty() && field_named(event->fields, shown.field) == nullptr)
        return "event \"" + shown.event + "\" has no field \"" + shown.field + "\"";
    return {};
}

}  // namespace

ModelHints::ModelHints(const ServiceModel& model) {
    // It was checked when the model was made of it.
    const auto source = json::parse(model.source, nullptr, false);
    if (!source.is_object()) return;
    if (const auto elements = source.find("elements"); elements != source.end()) {
        element_for_each_pin_ = elements->is_string();
        if (elements->is_number()) elements_ = elements->get<int>();
    }
    const auto events = source.value("events", json::object());
    for (const auto& [tag, event] : events.items()) {
        const bool advanced = event.value("advanced", false);
        const auto fields = event.value("fields", json::array());
        for (const auto& field : fields) {
            auto hints = read_hints(field);
            hints.advanced = hints.advanced || advanced;
            fields_[key_of('e', event["name"].get<std::string>(), field["name"].get<std::string>())] = hints;
        }
    }
    const auto commands = source.value("commands", json::object());
    for (const auto& [name, command] : commands.items()) {
        advanced_[name] = command.value("advanced", false);
        if (const auto writes = command.find("writes"); writes != command.end()) {
            auto shown = shown_from(writes->get<std::string>());
            const auto* event = model.event_named(shown.event);
            if (shown.field.empty() && event != nullptr) shown.field = event->fields.front().name;
            shown_[name] = shown;
        }
        if (const auto sets = command.find("sets"); sets != command.end())
            for (const auto& [key, value] : sets->items())
                sets_[name].push_back(sets_from(key, value));
        const auto arguments = command.value("args", json::array());
        for (const auto& argument : arguments)
            fields_[key_of('c', name, argument["name"].get<std::string>())] = read_hints(argument);
    }
}

FieldHints ModelHints::field(const EventModel& event, std::string_view field) const {
    const auto found = fields_.find(key_of('e', event.name, field));
    return found == fields_.end() ? FieldHints() : found->second;
}

FieldHints ModelHints::argument(const CommandModel& command, std::string_view argument) const {
    const auto found = fields_.find(key_of('c', command.name, argument));
    return found == fields_.end() ? FieldHints() : found->second;
}

bool ModelHints::advanced(const CommandModel& command) const {
    const auto found = advanced_.find(command.name);
    return found != advanced_.end() && found->second;
}

std::optional<ModelHints::Shown> ModelHints::shown_by(const CommandModel& command) const {
    const auto found = shown_.find(command.name);
    if (found == shown_.end()) return std::nullopt;
    return found->second;
}

const std::vector<ModelHints::Sets>* ModelHints::sets(const CommandModel& command) const {
    const auto found = sets_.find(command.name);
    return found == sets_.end() ? nullptr : &found->second;
}

std::string hints_fault(const ServiceModel& model, const json& document) {
    for (const auto& command : model.commands) {
        const auto& source = document["commands"][command.name];
        const auto place = "/commands/" + command.name;
        if (const auto writes = source.find("writes"); writes != source.end()) {
            if (auto fault = shown_fault(model, shown_from(writes->get<std::string>())); !fault.empty())
                return place + "/writes: " + fault;
        }
        if (const auto sets = source.find("sets"); sets != source.end())
            for (const auto& [key, value] : sets->items())
                if (auto fault = sets_fault(model, command, sets_from(key, value)); !fault.empty())
                    return place + "/sets: " + fault;
        for (std::size_t i = 0; i < command.args.size(); ++i) {
            const auto& argument = source["args"][i];
            const auto here = place + "/args/" + std::to_string(i) + "/default";
            if (!argument.contains("default")) continue;
            const auto type = command.args[i].type;
            if (type != ValueType::kInteger && type != ValueType::kNumber && type != ValueType::kColor)
                return here + ": only a number has a default";
            const auto written = write_value(command.args[i], argument["default"], Strictness::kStrict, here);
            if (!written) return written.error();
        }
    }
    return {};
}

}  // namespace asip::model
