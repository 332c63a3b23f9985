// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>

#include "asip/model/description.hpp"
#include "asip/model/json.hpp"
#include "asip/text/nearest.hpp"
#include "cli/ask/bus_session.hpp"
#include "cli/ask/retained.hpp"
#include "cli/commands/show.hpp"
#include "cli/declaration.hpp"
#include "cli/environment.hpp"
#include "cli/model/make.hpp"
#include "cli/output.hpp"
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

/// That this program knows.
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

/// What a kind reports and takes. An unknown kind is looked for on the bus.
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

struct Options {
    ModelOptions make;
    OutputOptions output{Output::kTable, {}};
};

int run(const Options& options, Environment& environment) {
    const auto& action = options.make.action;
    const bool makes = std::ranges::find(kModelActions, action) != kModelActions.end();
    const auto& files = options.make.files;
    if (action == "sketch" && files.empty())
        return environment.fail_with(
            {program::kExitUsage, "with which services? Write asipctl model sketch servo=9,10 weather"});
    if (makes && files.empty())
        return environment.fail_with(
            {program::kExitUsage, "of which model? Write asipctl model " + action + " FILE"});
    if (makes && action != "sketch" && files.size() > 1)
        return environment.fail_with(
            {program::kExitUsage, "one model at a time: \"" + action + "\" takes one FILE"});
    if (makes) return make_of_model(options.make, environment);
    if (!files.empty())
        return environment.fail_with(
            {program::kExitUsage, "\"" + action + "\" makes nothing of a file; " +
                                      "check, firmware, part, cpp, docs and sketch do"});
    return action.empty() ? list_kinds(options.output, environment)
                          : explain_kind(action, options.output, environment);
}

Run declare_model(Declaration& verb) {
    auto options = std::make_shared<Options>();
    auto& make = options->make;
    verb.argument("KIND|check|firmware|part|cpp|docs|sketch|...", make.action,
                  "The kind to explain, or what to do with FILE; without it, all kinds are listed",
                  Declaration::Needed::kNo);
    verb.arguments("FILE", make.files,
                   "A service model, a JSON file; for a sketch, services with their pins: servo=9,10",
                   Declaration::Needed::kNo);
    verb.option("--into", "FILE", make.output,
                "Where to: a folder for firmware, cpp and sketch, a file for part and docs");
    verb.option("--elements", "COUNT", make.elements,
                "How many elements the board has; default: as many as the examples show");
    verb.option("--image", "FILE", make.image, "Firmware image that the simulated board runs");
    verb.flag("--force", make.force, "Write over files that are there, but not over the one with your code");
    verb.output(
        options->output, {Output::kTable, Output::kName},
        {"kind", "version", "letter", "title", "events", "commands", "name", "id", "match", "element"});
    return [options](Environment& environment) { return run(*options, environment); };
}

}  // namespace

Verb model_verb() {
    return {"model",
            "Kinds of service: lists and explains them, and makes firmware, clients and pages of them",
            "A model says what a kind of service reports and takes. Built-in ones are known, and those of "
            "--services. A broker is asked\n"
            "only for a kind that is not known: a board may bring its own. For the services of one board: "
            "asipctl show BOARD/SERVICE.\n"
            "check     a model's form, its examples, and clashes with the models that are known\n"
            "firmware  an Arduino sketch: the class of the service, and a file for your code\n"
            "part      a board for asip-sim that runs the sketch, with a part in the place of the hardware\n"
            "cpp       a client on the C++ library, and tests made of the examples\n"
            "docs      the reference page\n"
            "sketch    an Arduino sketch with services of the library, by name or by chip, into the folder "
            "MyBoard\n"
            "docs/add-a-service.md goes all the way.\n"
            "Examples:\n"
            "  asipctl model\n"
            "  asipctl model servo\n"
            "  asipctl model distance -o json | jq .commands\n"
            "  asipctl model check fan.json\n"
            "  asipctl model firmware fan.json --into Fan\n"
            "  asipctl model sketch ds18b20=2 bme280 servo=9,10 --into Garden\n"
            "  asipctl model part fan.json --image build/sketch/uno/firmware/images/Fan.elf && asip-sim "
            "fan.board.json",
            declare_model, false};
}

}  // namespace asip::cli
