// SPDX-License-Identifier: Apache-2.0
#include <ostream>

#include "cli/declaration.hpp"
#include "cli/environment.hpp"

namespace asip::cli {
namespace {

Run declare_help(Declaration& verb) {
    auto name = std::make_shared<std::string>();
    verb.argument("VERB", *name,
                  "The command; without it, those that most people type are listed, with all every one",
                  Declaration::Needed::kNo);
    return [name](Environment& environment) {
        const auto text = environment.help(*name);
        if (!text) return environment.fail_with(text.error());
        environment.out << *text << std::flush;
        return program::kExitOk;
    };
}

}  // namespace

Verb help_verb() {
    return {"help", "Options and examples of a command", "Examples:\n  asipctl help send\n  asipctl help all",
            declare_help, false};
}

}  // namespace asip::cli
