// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "asip/model/argument_writer.hpp"
#include "asip/model/command_encoder.hpp"
#include "asip/model/hints.hpp"
#include "asip/model/json.hpp"
#include "asip/model/schema.hpp"
#include "asip/model/service_model.hpp"
#include "asip/text/json_reader.hpp"
#include "asip/text/printable.hpp"

namespace asip::model {
namespace {

using nlohmann::json;
using text::JsonReader;

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

ValueType type_from_text(const std::string& text) {
    for (const auto type :
         {ValueType::kNumber, ValueType::kText, ValueType::kColor, ValueType::kCount, ValueType::kList}) {
        if (text == to_text(type)) return type;
    }
    return ValueType::kInteger;
}

EventShape shape_of(JsonReader& event) {
    const auto shape = event.text("shape");
    if (shape == "plain") return EventShape::kPlain;
    if (shape == "ports") return EventShape::kPorts;
    if (shape == "port-map") return EventShape::kPortMap;
    if (shape == "map") return EventShape::kMap;
    return event.text("per") == "event" ? EventShape::kOnce : EventShape::kPerElement;
}

std::optional<double> bound(JsonReader& field, const char* key) {
    constexpr double kAny = std::numeric_limits<double>::max();
    if (!field.has(key)) return std::nullopt;
    return field.number(key, 0, -kAny, kAny);
}

Field read_field(JsonReader& reader) {
    Field field;
    field.name = reader.text("name");
    field.type = type_from_text(reader.text("type"));
    field.title = reader.text("title");
    field.unit = reader.text("unit");
    field.min = bound(reader, "min");
    field.max = bound(reader, "max");
    if (field.type == ValueType::kColor) {
        field.min = 0;
        field.max = 0xffffff;
    }
    field.max_length = reader.integer("max_length", 0, std::numeric_limits<std::size_t>::max());
    if (const auto names = reader.object("names"))
        for (const auto& [word, number] : names->value().items())
            field.names.emplace_back(word, number.get<std::int64_t>());
    field.of = reader.text("of");
    field.braces = reader.flag("braces");
    for (auto& item : reader.list("items"))
        field.items.push_back(read_field(item));
    return field;
}

EventModel read_event(const std::string& tag, JsonReader& reader) {
    EventModel event;
    event.tag = tag.front();
    event.name = reader.text("name");
    event.title = reader.text("title");
    event.shape = shape_of(reader);
    for (auto& field : reader.list("fields"))
        event.fields.push_back(read_field(field));
    return event;
}

CommandModel read_command(const std::string& name, JsonReader& reader) {
    CommandModel command;
    command.name = name;
    command.tag = reader.text("tag").front();
    command.title = reader.text("title");
    if (const auto answer = reader.text("answer"); !answer.empty()) command.answer = answer.front();
    if (const auto ms = reader.integer("answer_ms", 0, std::numeric_limits<int>::max()))
        command.answer_time = std::chrono::milliseconds(*ms);
    for (auto& argument : reader.list("args"))
        command.args.push_back(read_field(argument));
    return command;
}

/// Names the reason where the safe form of a command leads nowhere or leaves the ranges; empty otherwise.
std::string safe_fault(const ServiceModel& model, const CommandModel& command, const std::string& place) {
    const SafeForm& safe = *command.safe;
    const auto* target = model.command(safe.command);
    if (target == nullptr) return place + ": there is no command \"" + safe.command + "\"";
    const auto wanted = given_arguments(*target);
    const auto given = given_arguments(command);
    if (safe.arguments.size() != wanted.size())
        return place + ": has " + std::to_string(safe.arguments.size()) + " arguments, but " + target->name +
               " takes " + std::to_string(wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        const auto& argument = safe.arguments[i];
        if (!argument.given) {
            const auto written = write_value(*wanted[i], json(argument.number), Strictness::kStrict,
                                             place + "/" + std::to_string(i));
            if (!written) return written.error();
            continue;
        }
        const auto& source = *given[*argument.given];
        const bool fits = source.type == wanted[i]->type &&
                          wanted[i]->min.value_or(-kNoLimit) <= source.min.value_or(-kNoLimit) &&
                          wanted[i]->max.value_or(kNoLimit) >= source.max.value_or(kNoLimit);
        if (!fits) return place + ": " + target->name + " does not take every " + source.name;
    }
    return {};
}

/// "stop", or [null,0]. What it refers to is checked by safe_fault().
Expected<SafeForm> read_safe(const ServiceModel& model, const CommandModel& command, const json& value) {
    SafeForm safe;
    const auto given = given_arguments(command);
    if (value.is_array()) {
        safe.command = command.name;
        for (std::size_t i = 0; i < value.size(); ++i)
            if (value[i].is_null() && i < given.size())
                safe.arguments.push_back({i, 0});
            else
                safe.arguments.push_back({std::nullopt, value[i].is_null() ? 0 : value[i].get<double>()});
        return safe;
    }
    safe.command = value.get<std::string>();
    if (safe.command == command.name) return fail("is the command itself");
    const auto* target = model.command(safe.command);
    if (target == nullptr) return safe;
    for (const auto* argument : given_arguments(*target)) {
        const auto source = std::find_if(given.begin(), given.end(),
                                         [&](const Field* field) { return field->name == argument->name; });
        if (source == given.end())
            return fail(safe.command + " needs '" + argument->name + "', which " + command.name +
                        " does not have");
        safe.arguments.push_back({static_cast<std::size_t>(source - given.begin()), 0});
    }
    return safe;
}

/// Reads the safe forms, which refer to commands; the reason why one of them cannot be used, or nothing.
std::string read_safe_forms(ServiceModel& model, const json& document) {
    for (auto& command : model.commands) {
        const auto& source = document["commands"][command.name];
        if (!source.contains("safe")) {
            if (source.value("hold", false))
                return "/commands/" + command.name + "/hold: needs \"safe\": what undoes the command";
            continue;
        }
        const auto place = "/commands/" + command.name + "/safe";
        auto safe = read_safe(model, command, source["safe"]);
        if (!safe) return place + ": " + safe.error();
        command.safe = std::move(*safe);
        if (auto fault = safe_fault(model, command, place); !fault.empty()) return fault;
    }
    if (!document.contains("safe")) return {};
    for (std::size_t i = 0; i < document["safe"].size(); ++i) {
        const auto encoded = encode_json_command(model, document["safe"][i]);
        if (!encoded) return "/safe/" + std::to_string(i) + ": " + encoded.error();
        model.safe.push_back(encoded->line);
    }
    return {};
}

/// The reason why these fields contradict themselves, with its place; empty when they do not.
std::string fields_fault(const std::vector<Field>& fields, const std::string& place) {
    std::set<std::string> seen;
    for (std::size_t i = 0; i < fields.size(); ++i) {
        const auto& field = fields[i];
        const auto here = place + "/" + std::to_string(i);
        if (!seen.insert(field.name).second) return here + "/name: \"" + field.name + "\" is there twice";
        if (field.min && field.max && *field.min > *field.max) return here + "/min: is above max";
        const bool open_ended = field.type == ValueType::kList || field.type == ValueType::kText;
        if (open_ended && i + 1 != fields.size())
            return here + "/type: a " + std::string(to_text(field.type)) + " must come last";
        if (field.type == ValueType::kList) {
            if (field.items.empty()) return here + ": has no member \"items\"";
            if (auto fault = fields_fault(field.items, here + "/items"); !fault.empty()) return fault;
        } else if (!field.items.empty()) {
            return here + "/items: only a list has items";
        }
        if (field.type != ValueType::kCount) continue;
        const auto counted =
            std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.name == field.of; });
        if (counted == fields.end() || counted->type != ValueType::kList)
            return here + "/of: \"" + field.of + "\" is not a list";
    }
    return {};
}

std::string event_fault(const EventModel& event) {
    const auto place = std::string("/events/") + event.tag;
    const bool needs_fields = event.shape == EventShape::kPerElement || event.shape == EventShape::kOnce ||
                              event.shape == EventShape::kPlain || event.shape == EventShape::kMap;
    if (needs_fields && event.fields.empty()) return place + ": has no member \"fields\"";
    if (event.shape == EventShape::kMap && event.fields.size() != 1)
        return place + "/fields: a map has one field";
    // Fields of an event are separated by commas and colons, so a text need not come last.
    std::set<std::string> seen;
    for (const auto& field : event.fields)
        if (!seen.insert(field.name).second) return place + "/fields: \"" + field.name + "\" is there twice";
    return {};
}

std::string model_fault(const ServiceModel& model) {
    std::set<std::string> event_names;
    for (const auto& event : model.events) {
        if (!event_names.insert(event.name).second)
            return std::string("/events/") + event.tag + "/name: \"" + event.name + "\" is there twice";
        if (auto fault = event_fault(event); !fault.empty()) return fault;
    }
    for (const auto& command : model.commands) {
        const auto place = "/commands/" + command.name;
        if (auto fault = fields_fault(command.args, place + "/args"); !fault.empty()) return fault;
        if (command.answer != 0 && model.event(command.answer) == nullptr)
            return place + "/answer: there is no event \"" + command.answer + "\"";
    }
    return {};
}

/// The place of the first text that is not fit to be shown; examples are not shown and may hold anything.
std::string unshowable_place(const json& value, const std::string& place) {
    if (value.is_string() && !text::is_showable(value.get_ref<const std::string&>())) return place;
    if (!value.is_structured()) return {};
    for (const auto& [key, inner] : value.items()) {
        if (place.empty() && key == "examples") continue;
        if (auto found = unshowable_place(inner, place + "/" + key); !found.empty()) return found;
    }
    return {};
}

}  // namespace

Expected<ServiceModel> service_model_from_json(const nlohmann::json& document) {
    if (auto valid = check_schema(service_model_schema(), document); !valid) return fail(valid.error());
    if (auto place = unshowable_place(document, ""); !place.empty())
        return fail(place + ": holds control characters");
    // The schema has been checked: types are right and what is required is there, so that no fault is found.
    std::string fault;
    JsonReader reader(document, "", fault);
    ServiceModel model;
    model.name = reader.text("name");
    model.version = document["version"].get<int>();
    model.id = reader.text("id").front();
    model.title = reader.text("title");
    model.element = reader.text("element");
    model.match = reader.texts("match", JsonReader::kNoLimit, JsonReader::kNoLimit);
    for (auto& [tag, event] : reader.members("events"))
        model.events.push_back(read_event(tag, event));
    for (auto& [name, command] : reader.members("commands"))
        model.commands.push_back(read_command(name, command));
    if (!reader.ok()) return fail(std::move(fault));
    if (fault = model_fault(model); !fault.empty()) return fail(std::move(fault));
    if (fault = read_safe_forms(model, document); !fault.empty()) return fail(std::move(fault));
    if (fault = hints_fault(model, document); !fault.empty()) return fail(std::move(fault));
    auto source = document;
    if (document.contains("examples")) {
        model.example_source = dump_json(document["examples"]);
        source.erase("examples");
    }
    model.source = dump_json(source);
    model.hints = std::make_shared<const ModelHints>(model);
    return model;
}

Expected<ServiceModel> parse_service_model(std::string_view text) {
    const auto document = parse_json(text);
    if (!document) return fail("/: " + document.error());
    return service_model_from_json(*document);
}

std::vector<ModelExample> examples(const ServiceModel& model) {
    std::vector<ModelExample> result;
    if (model.example_source.empty()) return result;
    const auto list = parse_json(model.example_source);
    if (!list) return result;
    for (const auto& example : *list) {
        std::string fault;
        JsonReader reader(example, "", fault);
        const auto* value = reader.find("json");
        result.push_back({reader.text("wire"), value == nullptr ? "null" : dump_json(*value),
                          reader.text("error"), reader.text("ports")});
    }
    return result;
}

}  // namespace asip::model
