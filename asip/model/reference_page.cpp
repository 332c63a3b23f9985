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

/// One example of each form is enough for a reader; the model's file has them all.
std::string example_of(const ServiceModel& model, const std::string& begin) {
    for (const auto& example : examples(model))
        if (example.wire.starts_with(begin)) return cell(code(example.json)) + " | " + code(example.wire);
    return "- | -";
}

std::string command_row(const ServiceModel& model, const CommandModel& command) {
    const auto safe = safe_usage(model, command);
    const auto* answer = model.event(command.answer);
    auto meaning = cell(command.title);
    if (answer != nullptr) meaning += "; answered by " + code(answer->name);
    if (!safe.empty()) meaning += "; undone by " + code(safe);
    return "| " + code(command.name) + " | " + cell(usage(command)) + " | " + meaning + " | " +
           example_of(model, {model.id, ',', command.tag}) + " |\n";
}

std::string event_row(const ServiceModel& model, const EventModel& event) {
    std::vector<std::string> fields;
    for (const auto& field : event.fields)
        fields.push_back(describe(field));
    return "| event " + code(event.name) + " | " + cell(joined(fields)) + " | " + cell(event.title) + " | " +
           example_of(model, {'@', model.id, ',', event.tag}) + " |\n";
}

/// What nearly every sensor takes in the same way; the page of all services says it once.
bool is_usual(const ServiceModel& model, const CommandModel& command) {
    if (command.name == "report") return command.tag == 'A' && usage(command) == "period 0..65535 ms";
    return command.name == "measure" && command.tag == 'M' && model.event(command.answer) != nullptr;
}

std::string table(const ServiceModel& model, bool all) {
    std::string rows;
    for (const auto& event : model.events)
        rows += event_row(model, event);
    for (const auto& command : model.commands)
        if (all || !is_usual(model, command)) rows += command_row(model, command);
    if (rows.empty()) return {};
    std::string text =
        "| | fields, arguments | meaning | JSON | on the wire |\n| --- | --- | --- | --- | --- |\n" + rows;
    if (!model.safe.empty()) {
        std::vector<std::string> lines;
        for (const auto& line : model.safe)
            lines.push_back(code(line));
        text += "\nStopped by " + joined(lines) + ".\n";
    }
    return text + "\n";
}

std::string takes(const ServiceModel& model) {
    std::vector<std::string> usual;
    for (const auto& command : model.commands)
        if (is_usual(model, command)) usual.push_back(code(command.name));
    return joined(usual);
}

/// Has one event, and no command of its own.
bool is_sensor(const ServiceModel& model) {
    return model.events.size() == 1 && std::all_of(model.commands.begin(), model.commands.end(),
                                                   [&](const auto& each) { return is_usual(model, each); });
}

std::string sensor_row(const ServiceModel& model) {
    const auto& event = model.events.front();
    std::vector<std::string> fields;
    for (const auto& field : event.fields)
        fields.push_back(describe(field));
    return "| " + code(model.name) + ", letter " + code(std::string(1, model.id)) + " | " +
           joined(model.match) + " | " + cell(event.title) + " | " + cell(joined(fields)) + " | " +
           example_of(model, {'@', model.id, ',', event.tag}) + " | " + cell(takes(model)) + " |\n";
}

std::string section(const ServiceModel& model, const std::string& heading, bool all) {
    auto text = heading + " " + model.name + "\n\n" + model.title + ". Letter " +
                code(std::string(1, model.id)) + ", version " + std::to_string(model.version);
    if (!model.match.empty()) text += "; boards call it " + joined(model.match);
    if (!all && !takes(model).empty()) text += "; takes " + takes(model);
    return text + ".\n\n" + table(model, all);
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
        "Commands go as JSON to `asip/BOARD/SERVICE/in`, events come as JSON on `asip/BOARD/SERVICE/out`; "
        "the last column is what the\n"
        "board itself receives and sends. An argument that its model does not allow is refused, such as "
        "`period: 70000 is above 65535`.\n\n"
        "Where a service takes `measure`, `{\"measure\":null}` (`D,M`) asks for its event once. Where it "
        "takes `report`, `{\"report\":100}`\n(`D,A,100`) makes it come each 100 ms, at most each 65,535; 0 "
        "ends that.\n\n";
    text +=
        "## Sensors\n\n| service | boards call it | event | fields | JSON | on the wire | takes |\n"
        "| --- | --- | --- | --- | --- | --- | --- |\n";
    for (const auto& model : models.all())
        if (is_sensor(*model)) text += sensor_row(*model);
    text += "\n";
    for (const auto& model : models.all())
        if (!is_sensor(*model)) text += section(*model, "##", false);
    end_with_one_newline(text);
    return text;
}

std::string reference_page(const ServiceModel& model) {
    auto text = section(model, "#", true);
    end_with_one_newline(text);
    return text;
}

}  // namespace asip::model
