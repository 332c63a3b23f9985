// SPDX-License-Identifier: Apache-2.0
#include "asip/model/reference_page.hpp"

#include <algorithm>

#include "asip/model/command_encoder.hpp"

namespace asip::model {
namespace {

std::string code(const std::string& text) {
    return "`" + text + "`";
}

std::string cell(std::string text) {
    for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2)
        text.insert(at, "\\");
    return text.empty() ? "-" : text;
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const auto& word : words)
        text += (text.empty() ? "" : ", ") + word;
    return text;
}

std::string commands_table(const ServiceModel& model) {
    if (model.commands.empty()) return {};
    std::string text =
        "| command | tag | arguments | what it does | answer | safe form |\n"
        "| --- | --- | --- | --- | --- | --- |\n";
    for (const auto& command : model.commands) {
        const auto safe = safe_usage(model, command);
        const auto* answer = model.event(command.answer);
        text += "| " + code(command.name) + " | " + code(std::string(1, command.tag)) + " | " +
                cell(usage(command)) + " | " + cell(command.title) + " | " +
                (answer != nullptr ? code(answer->name) : "-") + " | " + (safe.empty() ? "-" : code(safe)) +
                " |\n";
    }
    if (!model.safe.empty()) {
        std::vector<std::string> lines;
        for (const auto& line : model.safe)
            lines.push_back(code(line));
        text += "\nStopped by " + joined(lines) + ".\n";
    }
    return text + "\n";
}

std::string events_table(const ServiceModel& model) {
    if (model.events.empty()) return {};
    std::string text = "| event | tag | meaning | fields |\n| --- | --- | --- | --- |\n";
    for (const auto& event : model.events) {
        std::vector<std::string> fields;
        for (const auto& field : event.fields)
            fields.push_back(describe(field));
        text += "| " + code(event.name) + " | " + code(std::string(1, event.tag)) + " | " +
                cell(event.title) + " | " + cell(joined(fields)) + " |\n";
    }
    return text + "\n";
}

/// One example of each form is enough for a reader; the model's file has them all.
std::string examples_table(const ServiceModel& model) {
    std::string events, commands, refused;
    std::vector<std::string> seen;
    for (const auto& example : examples(model)) {
        if (example.wire.empty()) {
            if (refused.empty())
                refused = "| refused | " + code(example.json) + " | " + example.error + " |\n";
            continue;
        }
        const auto key = example.wire.substr(0, example.is_event() ? 4 : 3);
        if (std::find(seen.begin(), seen.end(), key) != seen.end()) continue;
        seen.push_back(key);
        const auto row = cell(code(example.json)) + " | " + code(example.wire) + " |\n";
        (example.is_event() ? events : commands) +=
            (example.is_event() ? "| event | " : "| command | ") + row;
    }
    const auto rows = events + commands + refused;
    return rows.empty() ? rows : "| | JSON | on the wire |\n| --- | --- | --- |\n" + rows + "\n";
}

std::string section(const ServiceModel& model, const std::string& heading) {
    auto text = heading + " " + model.name + "\n\n" + model.title + ". Letter " +
                code(std::string(1, model.id)) + ", version " + std::to_string(model.version);
    if (!model.match.empty()) text += "; boards call it " + joined(model.match);
    return text + ".\n\n" + commands_table(model) + events_table(model) + examples_table(model);
}

void end_with_one_newline(std::string& text) {
    while (text.ends_with("\n\n"))
        text.pop_back();
}

}  // namespace

std::string reference_page(const ModelSet& models) {
    std::string text =
        "# Standard services\n\n"
        "<!-- Generated from services/*.json: see the end of service-models.md. -->\n\n"
        "What the service models define for each service that this project knows. Commands go as JSON to\n"
        "`asip/BOARD/SERVICE/in`, events come as JSON on `asip/BOARD/SERVICE/out`; the last column is what "
        "the board\n"
        "itself receives and sends.\n\n";
    for (const auto& model : models.all())
        text += section(*model, "##");
    end_with_one_newline(text);
    return text;
}

std::string reference_page(const ServiceModel& model) {
    auto text = section(model, "#");
    end_with_one_newline(text);
    return text;
}

}  // namespace asip::model
