// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "asip/model/command_encoder.hpp"
#include "asip/model/json.hpp"
#include "cli/generate/client_view.hpp"
#include "cli/generate/generate.hpp"
#include "cli/generate/names.hpp"
#include "cli/generate/render.hpp"

namespace asip::generate {
namespace {

using model::CommandModel;
using model::EventModel;
using model::Field;
using model::ServiceModel;
using model::ValueType;
using nlohmann::json;

std::string python_literal(const json& value) {
    if (value.is_null()) return "None";
    if (value.is_boolean()) return value.get<bool>() ? "True" : "False";
    if (!value.is_array()) return model::dump_json(value);
    std::vector<std::string> items;
    for (const auto& item : value)
        items.push_back(python_literal(item));
    return fmt::format("[{}]", fmt::join(items, ", "));
}

std::string python_type(const Field& field) {
    switch (field.type) {
        case ValueType::kNumber:
            return "float";
        case ValueType::kText:
            return "str";
        case ValueType::kColor:
            return "int | str";
        case ValueType::kList: {
            if (field.items.size() == 1) return fmt::format("Sequence[{}]", python_type(field.items.front()));
            std::vector<std::string> types;
            for (const auto& item : field.items)
                types.push_back(python_type(item));
            return fmt::format("Sequence[tuple[{}]]", fmt::join(types, ", "));
        }
        case ValueType::kInteger:
        case ValueType::kCount:
            break;
    }
    return field.names.empty() ? "int" : "int | str";
}

/// The call that checks a value: `_number("power", power, 0, 100)`.
std::string python_check(const Field& field, const std::string& place, const std::string& name) {
    const auto bounds = bounds_of(field);
    if (field.type == ValueType::kText)
        return fmt::format("_text({}, {}, {})", place, name,
                           field.max_length ? std::to_string(*field.max_length) : "None");
    if (field.type == ValueType::kColor) return fmt::format("_color({}, {})", place, name);
    if (field.type == ValueType::kList) {
        std::vector<std::string> items;
        for (const auto& item : field.items)
            items.push_back(fmt::format("({}, lambda place, value: {})", string_literal(item.name),
                                        python_check(item, "place", "value")));
        return fmt::format("_items({}, {}, {}, [{}])", place, name,
                           field.max_length ? std::to_string(*field.max_length) : "None",
                           fmt::join(items, ", "));
    }
    std::vector<std::string> names;
    for (const auto& [word, number] : field.names)
        names.push_back(fmt::format("{}: {}", string_literal(word), number));
    return fmt::format("_number({}, {}, {}, {}, {}, {{{}}})", place, name, plain_number(bounds.low),
                       plain_number(bounds.high), field.type == ValueType::kNumber ? "False" : "True",
                       fmt::join(names, ", "));
}

std::string python_event_type(const EventModel& event) {
    const auto object = pascal_case(event.name) + "Event";
    switch (form_of(event)) {
        case EventForm::kValue:
            return python_type(event.fields.front());
        case EventForm::kValues:
            return fmt::format("list[{}]", python_type(event.fields.front()));
        case EventForm::kObject:
            return object;
        case EventForm::kObjects:
            return fmt::format("list[{}]", object);
        case EventForm::kPorts:
            return "list[dict[str, int]]";
        case EventForm::kByKey:
            break;
    }
    return "dict[str, float]";
}

/// What an event of the examples decodes to, as code.
std::string python_event(const EventModel& event, const json& value) {
    const auto object = [&event](const json& members) {
        std::vector<std::string> fields;
        for (const auto& field : event.fields)
            fields.push_back(fmt::format("{}={}", python_name(field.name),
                                         python_literal(members.value(field.name, json()))));
        return fmt::format("{}Event({})", pascal_case(event.name), fmt::join(fields, ", "));
    };
    const auto form = form_of(event);
    if (form == EventForm::kObject) return object(value);
    if (form == EventForm::kByKey || form == EventForm::kPorts) return model::dump_json(value);
    if (form != EventForm::kObjects) return python_literal(value);
    std::vector<std::string> objects;
    for (const auto& one : value)
        objects.push_back(object(one));
    return fmt::format("[{}]", fmt::join(objects, ", "));
}

json event_view(const EventModel& event, Scope& members, Scope& classes, std::string& fault) {
    const auto name = snake_case(event.name);
    members.add("on_" + name, "event " + event.name);
    classes.add(pascal_case(event.name) + "Event", "event " + event.name);
    Scope scope("Python");
    json fields = json::array();
    for (const auto& field : event.fields) {
        scope.add(python_name(field.name), fmt::format("{}'s field {}", event.name, field.name));
        fields.push_back({{"name", python_name(field.name)},
                          {"key", string_literal(field.name)},
                          {"type", python_type(field)},
                          {"kind", field.type == ValueType::kText ? "str" : "(int, float)"},
                          {"what", comment(model::describe(field))}});
    }
    if (fault.empty()) fault = scope.fault();
    const auto form = form_of(event);
    json view = {{"name", name},
                 {"event", event.name},
                 {"event_key", string_literal(event.name)},
                 {"title", docstring(event.title.empty() ? event.name : event.title)},
                 {"type", python_event_type(event)},
                 {"class", pascal_case(event.name) + "Event"},
                 {"is_object", form == EventForm::kObject || form == EventForm::kObjects},
                 {"optional", form == EventForm::kObject}};
    constexpr std::array kForms{"value", "values", "object", "objects", "other", "other"};
    view[std::string(kForms[static_cast<std::size_t>(form)])] = true;
    if (!fields.empty()) view["first"] = fields.front();
    view["fields"] = std::move(fields);
    return view;
}

json command_view(const ServiceModel& model, const CommandModel& command, Scope& members,
                  std::string& fault) {
    auto name = python_name(command.name);
    if (name == "close") name += '_';
    members.add(name, "command " + command.name);
    Scope scope("Python");
    json arguments = json::array();
    for (const auto* argument : model::given_arguments(command)) {
        const auto parameter = python_name(argument->name);
        scope.add(parameter, fmt::format("{}'s argument {}", command.name, argument->name));
        arguments.push_back({{"name", parameter},
                             {"type", python_type(*argument)},
                             {"check", python_check(*argument, string_literal(argument->name), parameter)},
                             {"what", docstring(model::describe(*argument))},
                             {"more", !arguments.empty()}});
    }
    if (fault.empty()) fault = scope.fault();
    json view = {{"name", name},
                 {"request", "_request_" + snake_case(command.name)},
                 {"key", string_literal(command.name)},
                 {"title", docstring(command.title.empty() ? command.name : command.title)},
                 {"arguments", std::move(arguments)},
                 {"type", "None"}};
    if (const auto* answer = model.event(command.answer)) {
        view["type"] = python_event_type(*answer);
        view["answer"] = {{"event", snake_case(answer->name)}, {"key", string_literal(answer->name)}};
    }
    return view;
}

json tests_view(const ServiceModel& model) {
    json tests = json::array();
    for (const auto& [command, values, error, complete] : example_calls(model)) {
        std::vector<std::string> arguments;
        for (const auto& value : values)
            arguments.push_back(python_literal(value));
        json test = {
            {"number", std::to_string(tests.size() + 1)},
            {"call", fmt::format("_request_{}({})", snake_case(command->name), fmt::join(arguments, ", "))}};
        if (error.empty())
            test["request"] =
                fmt::format("{{{}: {}}}", string_literal(command->name), python_literal(values));
        else if (complete)
            test["refusal"] = model::dump_json(json(without_guess(error)));
        else
            test["wrong_call"] = true;
        tests.push_back(std::move(test));
    }
    for (const auto& [event, value] : example_events(model))
        tests.push_back({{"number", std::to_string(tests.size() + 1)},
                         {"event",
                          {{"name", snake_case(event->name)},
                           {"json", python_literal(json(model::dump_json(value)))},
                           {"literal", python_event(*event, value)}}}});
    return tests;
}

}  // namespace

Files python_client(const ServiceModel& model) {
    Scope members("Python"), classes("Python");
    std::string fault;
    json events = json::array(), commands = json::array();
    for (const auto& event : model.events)
        events.push_back(event_view(event, members, classes, fault));
    for (const auto& command : model.commands)
        commands.push_back(command_view(model, command, members, fault));
    for (const auto& found : {members.fault(), classes.fault(), fault})
        if (!found.empty()) return fail(found);
    const auto module = snake_case(model.name) + "_service";
    const json view = {{"class", pascal_case(model.name) + "Service"},
                       {"module", module},
                       {"service", string_literal(model.name)},
                       {"ref", model.ref()},
                       {"title", docstring(model.title)},
                       {"events", std::move(events)},
                       {"commands", std::move(commands)},
                       {"tests", tests_view(model)}};
    return std::vector<GeneratedFile>{
        {module + ".py", render(template_text("client.py"), view)},
        {"test_" + module + ".py", render(template_text("client_test.py"), view)}};
}

}  // namespace asip::generate
