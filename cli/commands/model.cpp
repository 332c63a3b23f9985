// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "cli/declaration.hpp"
#include "cli/model/kinds.hpp"
#include "cli/model/make.hpp"

namespace asip::cli {
namespace {

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
