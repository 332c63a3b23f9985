// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>

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

std::string item_type(const CommandModel& command, const Field& list) {
    return pascal_case(command.name) + pascal_case(list.name) + "Item";
}

/// The type of a single value.
std::string value_type(const Field& field) {
    if (field.type == ValueType::kText) return "std::string";
    return field.type == ValueType::kNumber ? "double" : "std::int64_t";
}

std::string argument_type(const CommandModel& command, const Field& field) {
    if (field.type != ValueType::kList) return value_type(field);
    return fmt::format("std::vector<{}>",
                       field.items.size() == 1 ? value_type(field.items.front()) : item_type(command, field));
}

std::string parameter_type(const CommandModel& command, const Field& field) {
    const auto type = argument_type(command, field);
    const bool is_large = field.type == ValueType::kText || field.type == ValueType::kList;
    return is_large ? fmt::format("const {}&", type) : type;
}

std::string bound_literal(double bound) {
    auto text = plain_number(bound);
    if (text.find_first_of(".e") == std::string::npos) text += ".0";
    return text;
}

/// A value of the examples as code; nothing where the argument cannot have it.
std::optional<std::string> value_literal(const Field& field, const json& value) {
    if (field.type == ValueType::kText)
        return value.is_string() ? std::optional(string_literal(value.get<std::string>())) : std::nullopt;
    if (value.is_boolean()) return value.get<bool>() ? "1" : "0";
    if (field.type == ValueType::kNumber)
        return value.is_number() ? std::optional(model::dump_json(value)) : std::nullopt;
    if (value.is_number_integer()) return model::dump_json(value);
    if (!value.is_string()) return std::nullopt;
    const auto word = value.get<std::string>();
    for (const auto& [name, number] : field.names)
        if (name == word) return std::to_string(number);
    const bool is_color = field.type == ValueType::kColor && word.size() == 7 && word.front() == '#' &&
                          word.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
    return is_color ? std::optional("0x" + word.substr(1)) : std::nullopt;
}

std::optional<std::string> argument_literal(const Field& field, const json& value) {
    if (field.type != ValueType::kList) return value_literal(field, value);
    std::vector<std::string> items;
    for (const auto& item : value) {
        std::vector<std::string> parts;
        for (std::size_t i = 0; i < field.items.size(); ++i) {
            const auto part = value_literal(field.items[i], field.items.size() == 1 ? item : item[i]);
            if (!part) return std::nullopt;
            parts.push_back(*part);
        }
        items.push_back(field.items.size() == 1 ? parts.front()
                                                : fmt::format("{{{}}}", fmt::join(parts, ", ")));
    }
    return fmt::format("{{{}}}", fmt::join(items, ", "));
}

/// What is sent for a value of the examples: numbers for names and colors.
json sent_value(const Field& field, const json& value) {
    if (field.type == ValueType::kList) {
        json items = json::array();
        for (const auto& item : value) {
            if (field.items.size() == 1) {
                items.push_back(sent_value(field.items.front(), item));
                continue;
            }
            json parts = json::array();
            for (std::size_t i = 0; i < field.items.size(); ++i)
                parts.push_back(sent_value(field.items[i], item[i]));
            items.push_back(std::move(parts));
        }
        return items;
    }
    if (field.type == ValueType::kText || value.is_number()) return value;
    const auto literal = value_literal(field, value);
    return literal ? json(std::stoll(*literal, nullptr, 0)) : value;
}

std::string field_type(const EventModel& event, const Field& field) {
    const auto type = value_type(field);
    return form_of(event) == EventForm::kObject ? fmt::format("std::optional<{}>", type) : type;
}

/// Whether an element has no value: its sensor did not answer.
bool lacks_a_number(const json& value) {
    return value.is_array() && std::any_of(value.begin(), value.end(), [](const json& element) {
               return element.is_null() ||
                      (element.is_object() && std::any_of(element.begin(), element.end(),
                                                          [](const json& one) { return one.is_null(); }));
           });
}

std::string cpp_event(const EventModel& event, const json& value) {
    const auto type = fmt::format("{}Event", pascal_case(event.name));
    const auto plain = [](const Field& field, const json& one) {
        return one.is_null()                    ? std::string("std::nullopt")
               : field.type == ValueType::kText ? string_literal(one.get<std::string>())
                                                : model::dump_json(one);
    };
    const auto object = [&](const json& members) {
        std::vector<std::string> fields;
        for (const auto& field : event.fields)
            fields.push_back(plain(field, members.value(field.name, json())));
        return fmt::format("{}", fmt::join(fields, ", "));
    };
    std::vector<std::string> parts;
    switch (form_of(event)) {
        case EventForm::kValue:
            return plain(event.fields.front(), value);
        case EventForm::kObject:
            return object(value);
        case EventForm::kValues:
            for (const auto& one : value)
                parts.push_back(plain(event.fields.front(), one));
            break;
        case EventForm::kObjects:
            for (const auto& one : value)
                parts.push_back(fmt::format("{{{}}}", object(one)));
            break;
        case EventForm::kByKey:
            for (const auto& [key, one] : value.items())
                parts.push_back(fmt::format("{{{}, {}}}", string_literal(key), model::dump_json(one)));
            break;
        case EventForm::kPorts:
            for (const auto& one : value)
                parts.push_back(
                    fmt::format("{{{}, {}}}", model::dump_json(one["port"]), model::dump_json(one["mask"])));
            break;
    }
    return fmt::format("{{{}}}", fmt::join(parts, ", "));
}

/// Collects what the header is filled with, and the first two names that became one.
class HeaderView {
  public:
    explicit HeaderView(const ServiceModel& model) : model_(model) {
        for (const char* own : {"watch", "next_event", "decode"})
            members_.add(own, "the client's own " + std::string(own));
        for (const auto& event : model.events)
            add_event(event);
        for (const auto& command : model.commands)
            add_command(command);
    }

    std::string fault() const { return members_.fault().empty() ? fault_ : members_.fault(); }

    json view() const {
        const auto file = snake_case(model_.name) + "_service";
        return {{"class", pascal_case(model_.name) + "Service"},
                {"file", file},
                {"service", string_literal(model_.name)},
                {"ref", model_.ref()},
                {"title", comment(model_.title)},
                {"has_events", !events_.empty()},
                {"events", events_},
                {"structs", structs_},
                {"names", names_},
                {"commands", commands_},
                {"tests", tests()}};
    }

  private:
    void add_event(const EventModel& event) {
        const auto type = pascal_case(event.name) + "Event";
        members_.add(type, "event " + event.name);
        Scope scope("C++");
        json fields = json::array();
        for (const auto& field : event.fields) {
            scope.add(cpp_name(field.name), fmt::format("{}'s field {}", event.name, field.name));
            fields.push_back({{"name", cpp_name(field.name)},
                              {"key", string_literal(field.name)},
                              {"type", field_type(event, field)},
                              {"value_type", value_type(field)},
                              {"what", comment(model::describe(field))},
                              {"more", !fields.empty()}});
        }
        if (fault_.empty()) fault_ = scope.fault();
        constexpr std::array kForms{"value", "values", "object", "objects", "by_key", "ports"};
        json view = {{"type", type},
                     {"event_key", string_literal(event.name)},
                     {"title", comment(event.title.empty() ? event.name : event.title)},
                     {"more", !events_.empty()},
                     {std::string(kForms[static_cast<std::size_t>(form_of(event))]), true}};
        if (!fields.empty()) view["first"] = fields.front();
        view["fields"] = std::move(fields);
        events_.push_back(std::move(view));
    }

    void add_command(const CommandModel& command) {
        auto name = cpp_name(command.name);
        if (name == "watch" || name == "next_event" || name == "decode") name += '_';
        members_.add(name, "command " + command.name);
        members_.add(snake_case(command.name) + "_request", "command " + command.name);
        Scope scope("C++");
        json arguments = json::array();
        for (const auto* argument : model::given_arguments(command)) {
            const auto parameter = cpp_name(argument->name);
            scope.add(parameter, fmt::format("{}'s argument {}", command.name, argument->name));
            arguments.push_back({{"name", parameter},
                                 {"type", parameter_type(command, *argument)},
                                 {"what", comment(model::describe(*argument))},
                                 {"check", check(*argument, string_literal(argument->name), parameter)},
                                 {"more", !arguments.empty()}});
            for (const auto& [word, number] : argument->names)
                add_name(command, *argument, word, number);
            if (argument->type == ValueType::kList && argument->items.size() > 1)
                add_struct(command, *argument);
        }
        if (fault_.empty()) fault_ = scope.fault();
        json view = {{"name", name},
                     {"request", snake_case(command.name) + "_request"},
                     {"key", string_literal(command.name)},
                     {"title", comment(command.title.empty() ? command.name : command.title)},
                     {"arguments", std::move(arguments)}};
        if (const auto* answer = model_.event(command.answer))
            view["answer"] = {{"type", pascal_case(answer->name) + "Event"}};
        commands_.push_back(std::move(view));
    }

    void add_name(const CommandModel& command, const Field& argument, const std::string& word,
                  std::int64_t number) {
        const auto name = "k" + pascal_case(command.name) + pascal_case(argument.name) + pascal_case(word);
        members_.add(name, command.name + "'s " + argument.name + " " + word);
        names_.push_back({{"name", name}, {"number", std::to_string(number)}});
    }

    void add_struct(const CommandModel& command, const Field& list) {
        const auto type = item_type(command, list);
        members_.add(type, "command " + command.name);
        Scope scope("C++");
        json fields = json::array();
        for (const auto& item : list.items) {
            scope.add(cpp_name(item.name), list.name + "'s " + item.name);
            fields.push_back({{"name", cpp_name(item.name)},
                              {"type", value_type(item)},
                              {"what", comment(model::describe(item))}});
        }
        if (fault_.empty()) fault_ = scope.fault();
        structs_.push_back({{"type", type}, {"of", command.name}, {"fields", std::move(fields)}});
    }

    /// The call that puts a value into `request`: `request.number("power", power, 0.0, 100.0)`.
    static std::string check(const Field& field, const std::string& place, const std::string& name) {
        const auto bounds = bounds_of(field);
        const auto longest =
            field.max_length ? std::to_string(*field.max_length) : std::string("request.kNoLimit");
        if (field.type == ValueType::kText) return fmt::format("text({}, {}, {})", place, name, longest);
        if (field.type != ValueType::kList)
            return fmt::format("{}({}, {}, {}, {})", field.type == ValueType::kNumber ? "decimal" : "whole",
                               place, name, bound_literal(bounds.low), bound_literal(bounds.high));
        std::vector<std::string> parts;
        for (const auto& item : field.items)
            parts.push_back(
                "request." +
                check(item, field.items.size() == 1 ? "place" : fmt::format("place + \"/{}\"", item.name),
                      field.items.size() == 1 ? "item" : "item." + cpp_name(item.name)));
        return fmt::format(
            "list({}, {}, {}, {}, [&request](const std::string& place, const auto& item) {{ {}; }})", place,
            name, longest, field.items.size() > 1 ? "true" : "false", fmt::join(parts, "; "));
    }

    json tests() const {
        json tests = json::array();
        for (const auto& [command, values, error, complete] : example_calls(model_)) {
            if (!complete) continue;  // does not compile, as it should
            const auto given = model::given_arguments(*command);
            std::vector<std::string> literals;
            json sent = json::array();
            for (std::size_t i = 0; i < given.size(); ++i) {
                const auto literal = argument_literal(*given[i], values[i]);
                if (!literal) break;
                literals.push_back(*literal);
                sent.push_back(sent_value(*given[i], values[i]));
            }
            if (literals.size() != given.size()) continue;
            json test = {{"call", fmt::format("{}_request({})", snake_case(command->name),
                                              fmt::join(literals, ", "))}};
            if (error.empty())
                test["request"] = string_literal(model::dump_json(json{{command->name, sent}}));
            else
                test["refusal"] = string_literal(without_guess(error));
            tests.push_back(std::move(test));
        }
        for (const auto& [event, value] : example_events(model_)) {
            if (lacks_a_number(value)) continue;  // it is NaN there, which equals nothing
            tests.push_back({{"event",
                              {{"json", string_literal(model::dump_json(json{{event->name, value}}))},
                               {"type", pascal_case(event->name) + "Event"},
                               {"literal", cpp_event(*event, value)}}}});
        }
        return tests;
    }

    const ServiceModel& model_;
    Scope members_{"C++"};
    std::string fault_;
    json events_ = json::array(), structs_ = json::array(), names_ = json::array(), commands_ = json::array();
};

}  // namespace

Files cpp_client(const ServiceModel& model) {
    const HeaderView header(model);
    if (const auto fault = header.fault(); !fault.empty()) return fail(fault);
    const auto view = header.view();
    const auto file = view["file"].get<std::string>();
    return std::vector<GeneratedFile>{{file + ".hpp", render(template_text("client.hpp"), view)},
                                      {file + "_test.cpp", render(template_text("client_test.cpp"), view)}};
}

}  // namespace asip::generate
