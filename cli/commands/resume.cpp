// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/stop.hpp"
#include "cli/declaration.hpp"

namespace asip::cli {
namespace {

Run declare_resume(Declaration& verb) {
    auto options = std::make_shared<StopOptions>();
    options->resume = true;
    verb.arguments("BOARD", options->boards, "Which boards; * and ? as in a shell", Declaration::Needed::kNo);
    declare_selector(verb, options->selector);
    verb.flag("--all", options->all, "Every board on the bus");
    verb.output(options->output, {Output::kTable},
                {"board", "status", "executed", "refused", "error", "reason", "code"});
    return [options](Environment& environment) { return run_stop(*options, environment); };
}

}  // namespace

Verb resume_verb() {
    return {"resume", "Let boards that were stopped take commands again",
            "Nothing moves by it: what was refused is not sent again.\n"
            "Exit status: 0 all resumed, 1 refused, 4 no answer.\n"
            "Examples:\n"
            "  asipctl resume robot\n"
            "  asipctl resume --all",
            declare_resume};
}

}  // namespace asip::cli
