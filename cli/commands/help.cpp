// SPDX-License-Identifier: Apache-2.0
#include <ostream>

#include "cli/declaration.hpp"
#include "cli/environment.hpp"

namespace asip::cli {
namespace {

Run declare_help(Declaration& verb) {
    auto name = std::make_shared<std::string>();
    verb.argument("VERB", *name, "The command; without it, all of them are listed", Declaration::Needed::kNo);
    return [name](Environment& environment) {
        const auto text = environment.help(*name);
        if (!text) return environment.fail_with(text.error());
        environment.out << *text << std::flush;
        return program::kExitOk;
    };
}

}  // namespace

Verb help_verb() {
    return {"help", "Options and examples of a command", "Example:\n  asipctl help send", declare_help,
            false};
}

}  // namespace asip::cli
