// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>
#include <ostream>

#include "cli/declaration.hpp"
#include "cli/environment.hpp"
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

int run_models(const OutputOptions& output, Environment& environment) {
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
    if (!output.for_people()) {
        records.finish();
    } else if (!table.empty()) {
        environment.out << table.render(environment.width, environment.colour);
    }
    environment.out << std::flush;
    return program::kExitOk;
}

Run declare_models(Declaration& verb) {
    auto output = std::make_shared<OutputOptions>();
    verb.output(*output, {Output::kTable, Output::kName},
                {"kind", "version", "letter", "title", "events", "commands"});
    return [output](Environment& environment) { return run_models(*output, environment); };
}

}  // namespace

Verb models_verb() {
    return {"models", "Kinds of service that this program knows",
            "The built-in ones, and those of --services. No broker is asked.\n"
            "Examples:\n"
            "  asipctl models\n"
            "  asipctl models --services ./my-models -o name",
            declare_models, false};
}

}  // namespace asip::cli
