// SPDX-License-Identifier: Apache-2.0
#include "sim/wiring/part.hpp"

#include <fmt/format.h>

namespace asip::sim {
namespace {

std::string usage_of(const PartKind& kind) {
    std::string usage;
    for (const auto& verb : kind.verbs) {
        usage += fmt::format("{}{}", usage.empty() ? "" : ", ", verb.name);
        if (!verb.argument.empty()) usage += fmt::format(" {}", verb.argument);
    }
    return usage.empty() ? "it only shows" : usage;
}

}  // namespace

Expected<void> Part::command(std::string_view verb, std::string_view argument) {
    const auto* found = kind_.verb(verb);
    if (found == nullptr)
        return fail(
            fmt::format("{} ({}) has no command \"{}\": {}", name_, kind_.name, verb, usage_of(kind_)));
    if (found->argument.empty() && !argument.empty())
        return fail(fmt::format("\"{}\" takes nothing after the part", verb));
    return perform(verb, argument);
}

Expected<void> Part::perform(std::string_view, std::string_view) {
    return {};
}

}  // namespace asip::sim
