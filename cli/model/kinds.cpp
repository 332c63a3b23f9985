// SPDX-License-Identifier: Apache-2.0
#include "cli/model/kinds.hpp"

#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/model/description.hpp"
#include "asip/model/json.hpp"
#include "asip/text/nearest.hpp"
#include "cli/ask/bus_session.hpp"
#include "cli/ask/retained.hpp"
#include "cli/commands/show.hpp"
#include "cli/text/table.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

std::vector<std::string> event_names(const model::ServiceModel& model) {
    std::vector<std::string> names;
    for (const auto& event : model.events)
        names.push_back(event.name);
    return names;
}

std::vector<std::string> command_names(const model::ServiceModel& model) {
    std::vector<std::string> names;
    for (const auto& command : model.commands)
        names.push_back(command.name);
    return names;
}

/// How each example looks on both sides: as it is sent to a board, and as JSON.
std::string examples_text(const model::ServiceModel& model, const Environment& environment) {
    Table table({{"EXAMPLE ON THE WIRE"}, {"AS JSON", false, 20}});
    for (const auto& example : model::examples(model))
        if (!example.wire.empty()) table.add({example.wire, example.json});
    return table.empty() ? std::string() : "\n" + table.render(environment.width, environment.colour);
}

/// A model that no file holds: a board brought it in its description.
Outcome<model::ModelPtr> model_of_boards(const std::string& kind, Environment& environment) {
    const auto unknown = "there is no kind \"" + kind + "\"" +
                         text::did_you_mean(kind, environment.models().names()) + "; see asipctl model";
    BusSession session(environment);
    if (const auto connected = session.connect(); !connected)
        return failure(
            program::kExitFailure,
            unknown + ". A board may bring its own, but no broker can be asked: " + connected.error().text);
    const auto retained = read_retained(environment, session, {environment.topics.description("+")});
    if (!retained) return tl::unexpected(retained.error());
    for (const auto& message : *retained) {
        const auto description = model::parse_description(message.payload);
        if (!description) continue;
        for (const auto& service : description->services)
            if (service.own_model && service.own_model->name == kind) return service.own_model;
    }
    return failure(program::kExitFailure, unknown + "; no board on the bus brings one of that name");
}

}  // namespace

int list_kinds(const OutputOptions& output, Environment& environment) {
    Table table(
        {{"KIND"}, {"LETTER"}, {"TITLE", false, 10}, {"REPORTS", false, 10}, {"COMMANDS", false, 10}});
    RecordPrinter records(output, RecordPrinter::Count::kList, environment.out);
    for (const auto& model : environment.models().all()) {
        const auto events = event_names(*model);
        const auto commands = command_names(*model);
        const std::string letter(1, model->id);
        if (!output.for_people()) {
            records.print({{"kind", model->name},
                           {"version", model->version},
                           {"letter", letter},
                           {"title", model->title},
                           {"events", events},
                           {"commands", commands}});
        } else if (output.form == Output::kName) {
            environment.out << model->name << '\n';
        } else {
            table.add({model->name, letter, model->title, listed(events), listed(commands)});
        }
    }
    if (!output.for_people())
        records.finish();
    else if (!table.empty())
        environment.out << table.render(environment.width, environment.colour);
    environment.out << std::flush;
    return program::kExitOk;
}

int explain_kind(const std::string& kind, const OutputOptions& output, Environment& environment) {
    auto model = environment.models().find(kind);
    if (!model) {
        auto found = model_of_boards(kind, environment);
        if (!found) return environment.fail_with(found.error());
        model = std::move(*found);
    }
    if (output.for_people()) {
        environment.out << painted(model->name, Colour::kBold, environment.colour) << "  " << model->title
                        << "\nletter " << model->id << ", version " << model->version << '\n'
                        << model_text(*model, environment.width, environment.colour)
                        << examples_text(*model, environment) << std::flush;
        return program::kExitOk;
    }
    const auto source = model::parse_json(model->source);
    if (!source) return environment.fail_with({program::kExitFailure, source.error()});
    RecordPrinter(output, RecordPrinter::Count::kOne, environment.out).print(*source);
    return program::kExitOk;
}

}  // namespace asip::cli
