// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/model/description.hpp"
#include "asip/model/json.hpp"
#include "asip/text/nearest.hpp"
#include "cli/ask/bus_session.hpp"
#include "cli/ask/retained.hpp"
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

/// A model that no file holds: a board brought it in its description.
Outcome<model::ModelPtr> model_of_boards(const ExplainOptions& options, Environment& environment) {
    const auto unknown = "there is no kind \"" + options.kind + "\"" +
                         text::did_you_mean(options.kind, environment.models().names()) +
                         "; see asipctl models";
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
            if (service.own_model && service.own_model->name == options.kind) return service.own_model;
    }
    return failure(program::kExitFailure, unknown + "; no board on the bus brings one of that name");
}

int run_explain(const ExplainOptions& options, Environment& environment) {
    auto model = environment.models().find(options.kind);
    if (!model) {
        auto found = model_of_boards(options, environment);
        if (!found) return environment.fail_with(found.error());
        model = std::move(*found);
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
            "A broker is asked only for a kind that is not built in: a board may bring its own. For the "
            "services of one board: asipctl show BOARD/SERVICE.\n"
            "Examples:\n"
            "  asipctl explain servo\n"
            "  asipctl explain distance -o json | jq .commands",
            declare_explain, false};
}

}  // namespace asip::cli
