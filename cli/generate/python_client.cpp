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
using model::Field;
using model::ServiceModel;
using model::ValueType;
using nlohmann::json;

/// Names that asip.Service has itself: a command of such a name is called by service.command("read").
constexpr std::array kServiceNames{"name",    "title", "board",  "model",    "unit", "updated",
                                   "command", "read",  "stream", "on_value", "hold", "begin"};

std::string python_text(const std::string& text) {
    return model::dump_json(json(text));
}

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
        case ValueType::kList:
            return "Sequence[Any]";
        case ValueType::kInteger:
        case ValueType::kCount:
            break;
    }
    return field.names.empty() ? "int" : "int | str";
}

json command_view(const ServiceModel& model, const CommandModel& command, Scope& members,
                  std::string& fault) {
    const auto name = python_name(command.name);
    members.add(name, "command " + command.name);
    Scope scope("Python");
    json arguments = json::array();
    for (const auto* argument : model::given_arguments(command)) {
        const auto parameter = python_name(argument->name);
        scope.add(parameter, fmt::format("{}'s argument {}", command.name, argument->name));
        arguments.push_back({{"name", parameter},
                             {"type", python_type(*argument)},
                             {"what", docstring(model::describe(*argument))}});
    }
    if (fault.empty()) fault = scope.fault();
    return {{"name", name},
            {"title", docstring(command.title.empty() ? command.name : command.title)},
            {"has_arguments", !arguments.empty()},
            {"arguments", std::move(arguments)},
            {"type", model.event(command.answer) != nullptr ? "Any" : "None"}};
}

json tests_view(const ServiceModel& model) {
    json tests = json::array();
    for (const auto& [command, values, error, complete] : example_calls(model)) {
        json test = {{"number", std::to_string(tests.size() + 1)}, {"command", python_text(command->name)}};
        test[error.empty() ? "request" : "refused"] = python_literal(values);
        if (!error.empty())
            test["refusal"] = model::dump_json(json(complete ? without_guess(error) : command->name));
        tests.push_back(std::move(test));
    }
    for (const auto& [event, value] : example_events(model))
        tests.push_back({{"number", std::to_string(tests.size() + 1)},
                         {"event", python_text(event->name)},
                         {"json", python_literal(json(model::dump_json(value)))}});
    return tests;
}

}  // namespace

Files python_client(const ServiceModel& model) {
    Scope members("Python");
    std::string fault;
    json commands = json::array();
    for (const auto& command : model.commands) {
        auto view = command_view(model, command, members, fault);
        if (std::find(kServiceNames.begin(), kServiceNames.end(), view["name"]) == kServiceNames.end())
            commands.push_back(std::move(view));
    }
    for (const auto& found : {members.fault(), fault})
        if (!found.empty()) return fail(found);
    const auto module = snake_case(model.name) + "_service";
    const json view = {{"class", pascal_case(model.name)},
                       {"module", module},
                       {"attribute", python_name(model.name)},
                       {"service", python_text(model.name)},
                       {"ref", model.ref()},
                       {"title", docstring(model.title)},
                       {"commands", std::move(commands)},
                       {"source", python_text(json::parse(model.source).dump(-1, ' ', true))},
                       {"tests", tests_view(model)}};
    return std::vector<GeneratedFile>{
        {module + ".py", render(template_text("client.py"), view)},
        {"test_" + module + ".py", render(template_text("client_test.py"), view)}};
}

}  // namespace asip::generate
