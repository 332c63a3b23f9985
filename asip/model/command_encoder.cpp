// SPDX-License-Identifier: Apache-2.0
#include "asip/model/command_encoder.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "asip/model/argument_writer.hpp"
#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "asip/protocol/body.hpp"
#include "asip/protocol/limits.hpp"
#include "asip/protocol/request.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"

namespace asip::model {
namespace {

using nlohmann::json;

std::string wrong_count(const CommandModel& command, std::size_t given) {
    const auto args = given_arguments(command);
    const auto number = std::to_string(given);
    if (args.empty()) return command.name + " takes no argument, not " + number;
    std::string names;
    for (const auto* argument : args)
        names += (names.empty() ? "" : ", ") + argument->name;
    const auto count = std::to_string(args.size()) + (args.size() == 1 ? " argument (" : " arguments (");
    return command.name + " takes " + count + names + "), not " + number;
}

/// The line that undoes a command with these values, which have been checked.
Expected<std::string> safe_line(const ServiceModel& model, const SafeForm& safe, const json& values,
                                Strictness strictness) {
    const auto& command = *model.command(safe.command);
    json arguments = json::array();
    for (const auto& argument : safe.arguments)
        arguments.push_back(argument.given ? values[*argument.given] : json(argument.number));
    const auto written = write_arguments(command, arguments, strictness);
    if (!written) return fail(written.error());
    return std::string{model.id, ',', command.tag} + *written;
}

Expected<EncodedCommand> finish(const ServiceModel& model, const CommandModel& command, const json& values,
                                Strictness strictness) {
    const auto args = given_arguments(command);
    if (values.size() > args.size()) return fail(wrong_count(command, values.size()));
    if (values.size() < args.size())
        return fail(command.name + ": argument '" + args[values.size()]->name + "' is missing");
    const auto arguments = write_arguments(command, values, strictness);
    if (!arguments) return fail(arguments.error());
    EncodedCommand result{{}, command.name, model.id, command.tag, command.answer, command.answer_time, {}};
    result.line = std::string{model.id, ',', command.tag} + *arguments;
    if (result.line.size() > protocol::kMaxRequestBytes) {
        return fail(command.name + ": the request would be " + std::to_string(result.line.size()) +
                    " bytes long, above " + std::to_string(protocol::kMaxRequestBytes) +
                    "; send it in parts");
    }
    if (command.safe) {
        auto safe = safe_line(model, *command.safe, values, strictness);
        if (!safe) return fail(safe.error());
        result.safe = std::move(*safe);
    }
    return result;
}

Unexpected<std::string> unknown_command(const ServiceModel& model, std::string_view name) {
    std::vector<std::string> names;
    std::string all;
    for (const auto& command : model.commands) {
        names.push_back(command.name);
        all += (all.empty() ? "" : ", ") + command.name;
    }
    const auto shown = text::printable(name, kMaxNameBytes);
    const auto near = text::nearest(shown, names);
    if (near) return fail("no command '" + shown + "'; did you mean '" + *near + "'?");
    if (all.empty()) return fail("no command '" + shown + "'; " + model.name + " takes none");
    return fail("no command '" + shown + "'; " + model.name + " has " + all);
}

/// Whether these values are the one list argument itself, not an array that holds it.
bool is_list_itself(const Field& list, const json& values) {
    if (values.size() != 1 || !values.front().is_array()) return true;
    const auto& inner = values.front();
    if (list.items.size() == 1) return false;
    return inner.empty() ||
           !(inner.front().is_array() || inner.front().is_object() || inner.front().is_string());
}

/// {"servo":0,"angle":90} in the order of the arguments.
Expected<json> order_members(const CommandModel& command, const json& members) {
    const auto args = given_arguments(command);
    std::vector<std::string> names;
    names.reserve(args.size());
    for (const auto* argument : args)
        names.push_back(argument->name);
    for (auto it = members.begin(); it != members.end(); ++it) {
        if (std::find(names.begin(), names.end(), it.key()) != names.end()) continue;
        const auto shown = text::printable(it.key(), kMaxNameBytes);
        const auto near = text::nearest(shown, names);
        return fail(command.name + " has no argument '" + shown + "'" +
                    (!near ? "" : "; did you mean '" + *near + "'?"));
    }
    json values = json::array();
    for (const auto& name : names) {
        const auto found = members.find(name);
        if (found == members.end()) return fail(command.name + ": argument '" + name + "' is missing");
        values.push_back(*found);
    }
    return values;
}

/// A list as it stands on the wire, to an array of its items as text.
Expected<json> list_from_text(const Field& list, std::string_view text) {
    if (list.braces) {
        if (text.size() < 2 || text.front() != '{' || text.back() != '}')
            return fail(list.name + ": needs braces { }");
        text = text.substr(1, text.size() - 2);
    }
    json items = json::array();
    if (text.empty()) return items;
    for (const auto item : protocol::split_fields(text, ','))
        items.push_back(std::string(item));
    return items;
}

/// "2,9,10" to values; the counts in it must be right.
Expected<json> values_from_text(const CommandModel& command, std::string_view parameters, bool any) {
    json values = json::array();
    std::vector<std::pair<const Field*, std::string>> counts;
    for (std::size_t i = 0; i < command.args.size() && any; ++i) {
        const auto& argument = command.args[i];
        const bool rest = argument.type == ValueType::kList || argument.type == ValueType::kText;
        const auto comma = rest ? std::string_view::npos : parameters.find(',');
        const auto part = parameters.substr(0, comma);
        if (argument.type == ValueType::kList) {
            auto items = list_from_text(argument, part);
            if (!items) return items;
            for (const auto& [count, given] : counts) {
                if (count->of == argument.name && given != std::to_string(items->size())) {
                    return fail(count->name + " is " + given + ", but " + argument.name + " holds " +
                                std::to_string(items->size()));
                }
            }
            values.push_back(std::move(*items));
        } else if (argument.type == ValueType::kCount) {
            counts.emplace_back(&argument, std::string(part));
        } else {
            values.push_back(std::string(part));
        }
        any = comma != std::string_view::npos;
        parameters.remove_prefix(any ? comma + 1 : parameters.size());
    }
    if (any)
        return fail(wrong_count(
            command, values.size() + 1 +
                         static_cast<std::size_t>(std::count(parameters.begin(), parameters.end(), ','))));
    return values;
}

}  // namespace

Expected<nlohmann::json> argument_values(const CommandModel& command, const nlohmann::json& given) {
    const auto args = given_arguments(command);
    const bool one_list = args.size() == 1 && args.front()->type == ValueType::kList;
    if (given.is_null()) return json::array();
    if (given.is_object()) return order_members(command, given);
    if (given.is_array()) {
        if (!one_list || !is_list_itself(*args.front(), given)) return given;
        json values = json::array();
        values.push_back(given);
        return values;
    }
    if (args.empty() && given == json(true)) return json::array();
    json values = json::array();
    values.push_back(given);
    return values;
}

Expected<EncodedCommand> encode_json_command(const ServiceModel& model, const nlohmann::json& command) {
    if (!command.is_object()) return fail("a command is an object such as {\"NAME\":[ARGUMENTS]}");
    const std::string* name = nullptr;
    const json* given = nullptr;
    for (auto it = command.begin(); it != command.end(); ++it) {
        if (it.key() == "id" || it.key() == "reply_to") continue;
        if (name != nullptr)
            return fail("one command at a time: '" + text::printable(*name, kMaxNameBytes) + "' or '" +
                        text::printable(it.key(), kMaxNameBytes) + "'");
        name = &it.key();
        given = &it.value();
    }
    if (name == nullptr) return fail("it has no command");
    const auto* known = model.command(*name);
    if (known == nullptr) return unknown_command(model, *name);
    const auto values = argument_values(*known, *given);
    if (!values) return fail(values.error());
    return finish(model, *known, *values, Strictness::kStrict);
}

namespace {

/// A command that the board accepts, and what was given for each argument, as text.
struct ReadCommand {
    const CommandModel* model = nullptr;
    EncodedCommand encoded;
    json values;
};

Expected<ReadCommand> read_text_command(const ServiceModel& model, std::string_view text) {
    const auto line = std::string{model.id, ','} + std::string(text.substr(0, protocol::kMaxPayloadBytes));
    const auto request = protocol::parse_request(line);
    if (!request) return fail(request.error());
    const bool any = line.size() > 3;
    std::optional<std::string> reason;
    for (const auto& command : model.commands) {
        if (command.tag != request->tag) continue;
        auto values = values_from_text(command, request->parameters, any);
        auto result = values ? finish(model, command, *values, Strictness::kLenient) : fail(values.error());
        if (result) return ReadCommand{&command, std::move(*result), std::move(*values)};
        if (!reason) reason = result.error();
    }
    if (reason) return fail(*reason);
    return fail(model.name + " has no command with tag '" + request->tag + "'");
}

/// A value that was read from text and checked, as JSON has it.
json typed(const Field& field, const json& value) {
    if (field.type == ValueType::kList) {
        json items = json::array();
        for (const auto& item : value) {
            const auto parts = protocol::split_fields(item.get_ref<const std::string&>());
            json fields = json::array();
            for (std::size_t i = 0; i < parts.size() && i < field.items.size(); ++i)
                fields.push_back(typed(field.items[i], std::string(parts[i])));
            items.push_back(fields.size() == 1 ? fields.front() : std::move(fields));
        }
        return items;
    }
    if (field.type == ValueType::kText) return value;
    return json_number(*number_of(field, value, Strictness::kLenient));
}

}  // namespace

Expected<EncodedCommand> encode_text_command(const ServiceModel& model, std::string_view text) {
    return read_text_command(model, text).map([](ReadCommand&& read) { return std::move(read.encoded); });
}

Expected<RequestValues> request_values(const ServiceModel& model, std::string_view text) {
    const auto read = read_text_command(model, text);
    if (!read) return fail(read.error());
    const auto args = given_arguments(*read->model);
    RequestValues result{read->model, json::array()};
    for (std::size_t i = 0; i < args.size(); ++i)
        result.values.push_back(typed(*args[i], read->values[i]));
    return result;
}

namespace {

/// {"angle=90","servo=0"} as an object by names; nothing: some word is none of these.
std::optional<json> named_words(const CommandModel& command, std::span<const std::string> words) {
    if (words.empty()) return std::nullopt;
    json object = json::object();
    for (const auto& word : words) {
        const auto sign = word.find('=');
        const auto name = word.substr(0, sign);
        const auto args = given_arguments(command);
        const bool known =
            sign != std::string::npos && !object.contains(name) &&
            std::any_of(args.begin(), args.end(), [&](const auto* each) { return each->name == name; });
        if (!known) return std::nullopt;
        object[name] = word.substr(sign + 1);
    }
    return object;
}

}  // namespace

Expected<EncodedCommand> encode_word_command(const ServiceModel& model, std::span<const std::string> words) {
    if (words.empty()) return fail("it has no command");
    const auto* known = model.command(words.front());
    if (known == nullptr && words.front().size() == 1) known = model.command_with_tag(words.front().front());
    if (known == nullptr) return unknown_command(model, words.front());
    if (const auto named = named_words(*known, words.subspan(1))) {
        const auto values = argument_values(*known, *named);
        if (!values) return fail(values.error());
        return finish(model, *known, *values, Strictness::kLenient);
    }
    const auto args = given_arguments(*known);
    json values = json::array();
    for (std::size_t i = 1; i < words.size(); ++i) {
        const bool at_last = values.size() + 1 >= args.size() && !args.empty();
        const auto type = at_last ? args.back()->type : ValueType::kInteger;
        if (at_last && type == ValueType::kList) {
            json items = json::array();
            for (; i < words.size(); ++i)
                items.push_back(words[i]);
            values.push_back(std::move(items));
        } else if (at_last && type == ValueType::kText && values.size() + 1 == args.size()) {
            std::string text = words[i++];
            for (; i < words.size(); ++i)
                text += " " + words[i];
            values.push_back(std::move(text));
        } else {
            values.push_back(words[i]);
        }
    }
    return finish(model, *known, values, Strictness::kLenient);
}

}  // namespace asip::model
