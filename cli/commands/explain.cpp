// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/model/json.hpp"
#include "asip/text/nearest.hpp"
#include "cli/commands/show.hpp"
#include "cli/declaration.hpp"
#include "cli/environment.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {
namespace {

struct ExplainOptions {
    std::string kind;
    OutputOptions output{};
};

/// How each example looks on both sides: as it is sent to a board, and as JSON.
std::string examples_text(const model::ServiceModel& model, const Environment& environment) {
    Table table({{"EXAMPLE ON THE WIRE"}, {"AS JSON", false, 20}});
    for (const auto& example : model::examples(model)) {
        if (!example.wire.empty()) table.add({example.wire, example.json});
    }
    return table.empty() ? std::string() : "\n" + table.render(environment.width, environment.colour);
}

int run_explain(const ExplainOptions& options, Environment& environment) {
    const auto model = environment.models().find(options.kind);
    if (!model) {
        return environment.fail_with(
            {program::kExitFailure, "there is no kind \"" + options.kind + "\"" +
                                        text::did_you_mean(options.kind, environment.models().names()) +
                                        "; see asipctl models"});
    }
    if (options.output.for_people()) {
        environment.out << painted(model->name, Colour::kBold, environment.colour) << "  " << model->title
                        << "\nletter " << model->id << ", version " << model->version << '\n'
                        << model_text(*model, environment.width, environment.colour)
                        << examples_text(*model, environment) << std::flush;
        return program::kExitOk;
    }
    const auto source = model::parse_json(model->source);
    if (!source) return environment.fail_with({program::kExitFailure, source.error()});
    RecordPrinter(options.output, RecordPrinter::Count::kOne, environment.out).print(*source);
    return program::kExitOk;
}

Run declare_explain(Declaration& verb) {
    auto options = std::make_shared<ExplainOptions>();
    verb.argument("KIND", options->kind, "Name of a service model: distance, servo, ...");
    verb.output(options->output, {Output::kText},
                {"name", "version", "id", "match", "title", "element", "events", "commands"});
    return [options](Environment& environment) { return run_explain(*options, environment); };
}

}  // namespace

Verb explain_verb() {
    return {"explain", "What a kind of service reports and takes, with examples",
            "No broker is asked. For the services of one board: asipctl show BOARD/SERVICE.\n"
            "Examples:\n"
            "  asipctl explain servo\n"
            "  asipctl explain distance -o json | jq .commands",
            declare_explain, false};
}

}  // namespace asip::cli
