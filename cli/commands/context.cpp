// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/mqtt/options.hpp"
#include "asip/program/exit_status.hpp"
#include "cli/declaration.hpp"
#include "cli/environment.hpp"
#include "cli/find/profiles.hpp"
#include "cli/output.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {
namespace {

struct ProfileOptions {
    std::string action = "list";
    std::string name;
    std::string address;
    OutputOptions output{Output::kTable, {}};
};

int list_profiles(const Profiles& profiles, const OutputOptions& output, Environment& environment) {
    Table table({{"CONTEXT"}, {"BROKER"}, {"USER"}, {""}});
    RecordPrinter records(output, RecordPrinter::Count::kList, environment.out);
    const auto current = profiles.current();
    for (const auto& name : profiles.names()) {
        const auto profile = profiles.find(name);
        if (!profile) {
            environment.note(profile.error());
            continue;
        }
        auto broker = profile->value("broker");
        if (broker.empty()) broker = profile->value("credentials");
        if (!output.for_people()) {
            records.print({{"name", name},
                           {"broker", broker},
                           {"user", profile->value("user")},
                           {"current", name == current}});
        } else if (output.form == Output::kName) {
            environment.out << name << '\n';
        } else {
            table.add({name, broker, profile->value("user"), name == current ? "current" : ""});
        }
    }
    if (!output.for_people()) records.finish();
    if (!table.empty()) environment.out << table.render(environment.width, environment.colour);
    environment.out << std::flush;
    return program::kExitOk;
}

/// Options whose value is a file: where they are used, the folder is another.
bool is_file_option(const std::string& name) {
    return name == "credentials" || name == "password-file" || name == "ca" || name == "cert" ||
           name == "key" || name == "services";
}

Expected<void> add_profile(const ProfileOptions& options, Profiles& profiles,
                           const Environment& environment) {
    Profile profile{options.name, {}};
    if (!options.address.empty()) {
        if (const auto address = mqtt::parse_broker(options.address); !address) return fail(address.error());
        profile.options.emplace_back("broker", options.address);
    }
    for (const auto& [name, value] : environment.typed_options) {
        if (name == "broker" || name == "config" || name == "context")
            return fail("--" + name + " is not kept; write asipctl context add NAME ADDRESS");
        profile.options.emplace_back(
            name, is_file_option(name) ? std::filesystem::absolute(value).string() : value);
    }
    if (options.address.empty() && profile.value("credentials").empty())
        return fail("where is it? asipctl context add NAME ADDRESS, or with --credentials FILE");
    return profiles.add(profile);
}

int run_profile_verb(const ProfileOptions& options, Environment& environment) {
    auto profiles = Profiles::of_user(program::environment_variable);
    if (!profiles)
        return environment.fail_with({program::kExitFailure, "neither HOME nor XDG_CONFIG_HOME is set"});
    if (options.action == "list") return list_profiles(*profiles, options.output, environment);
    const bool needs_name = options.action != "use";
    if (needs_name && options.name.empty())
        return environment.fail_with(
            {program::kExitUsage, "which one? asipctl context " + options.action + " NAME"});
    const auto done = options.action == "add"   ? add_profile(options, *profiles, environment)
                      : options.action == "use" ? profiles->use(options.name)
                                                : profiles->remove(options.name);
    if (!done)
        return environment.fail_with(
            {options.action == "add" ? program::kExitUsage : program::kExitFailure, done.error()});
    if (options.action == "add" && profiles->names().size() == 1)
        environment.note("now: asipctl context use " + options.name);
    return program::kExitOk;
}

Run declare_profiles(Declaration& verb) {
    auto options = std::make_shared<ProfileOptions>();
    verb.argument("list|add|use|remove", options->action, "What to do; default list",
                  Declaration::Needed::kNo);
    verb.argument("NAME", options->name, "Which; `use` without one: none", Declaration::Needed::kNo);
    verb.argument("ADDRESS", options->address, "Of the broker, for `add`", Declaration::Needed::kNo);
    verb.output(options->output, {Output::kTable, Output::kName}, {"name", "broker", "user", "current"});
    return [options](Environment& environment) { return run_profile_verb(*options, environment); };
}

}  // namespace

Verb context_verb() {
    return {
        "context", "Names for buses, with how each is reached",
        "`add` keeps the options of every command that are given with it (--user, --password-file, --ca,\n"
        "--credentials, --topic-root, ...) in a file of yours; `use` makes one the default, --context names "
        "one\n"
        "for one command. A broker that is given otherwise counts, and then nothing of the context is used.\n"
        "Examples:\n"
        "  asipctl context add lab mqtts://lab.local --user ann --password-file ~/.lab --ca lab.crt\n"
        "  asipctl context use lab\n"
        "  asipctl --context workshop list",
        declare_profiles, false};
}

}  // namespace asip::cli
