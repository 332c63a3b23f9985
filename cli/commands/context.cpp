// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/mqtt/options.hpp"
#include "cli/declaration.hpp"
#include "cli/find/named_buses.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {
namespace {

struct ContextOptions {
    std::string action = "list";
    std::string name;
    std::string address;
    OutputOptions output{Output::kTable, {}};
};

int list_contexts(const NamedBuses& buses, const OutputOptions& output, Context& context) {
    Table table({{"CONTEXT"}, {"BROKER"}, {"USER"}, {""}});
    RecordPrinter records(output, RecordPrinter::Count::kList, context.out);
    const auto current = buses.current();
    for (const auto& name : buses.names()) {
        const auto bus = buses.find(name);
        if (!bus) {
            context.note(bus.error());
            continue;
        }
        auto broker = bus->value("broker");
        if (broker.empty()) broker = bus->value("credentials");
        if (!output.for_people()) {
            records.print({{"name", name},
                           {"broker", broker},
                           {"user", bus->value("user")},
                           {"current", name == current}});
        } else if (output.form == Output::kName) {
            context.out << name << '\n';
        } else {
            table.add({name, broker, bus->value("user"), name == current ? "current" : ""});
        }
    }
    if (!output.for_people()) records.finish();
    if (!table.empty()) context.out << table.render(context.width, context.colour);
    context.out << std::flush;
    return program::kExitOk;
}

/// Options whose value is a file: where they are used, the folder is another.
bool is_file_option(const std::string& name) {
    return name == "credentials" || name == "password-file" || name == "ca" || name == "cert" ||
           name == "key" || name == "services";
}

Expected<void> add_context(const ContextOptions& options, NamedBuses& buses, const Context& context) {
    NamedBus bus{options.name, {}};
    if (!options.address.empty()) {
        if (const auto address = mqtt::parse_broker(options.address); !address) return fail(address.error());
        bus.options.emplace_back("broker", options.address);
    }
    for (const auto& [name, value] : context.typed_options) {
        if (name == "broker" || name == "config" || name == "context")
            return fail("--" + name + " is not kept; write asipctl context add NAME ADDRESS");
        bus.options.emplace_back(name,
                                 is_file_option(name) ? std::filesystem::absolute(value).string() : value);
    }
    if (options.address.empty() && bus.value("credentials").empty())
        return fail("where is it? asipctl context add NAME ADDRESS, or with --credentials FILE");
    return buses.add(bus);
}

int run_context(const ContextOptions& options, Context& context) {
    auto buses = NamedBuses::of_user(program::environment_variable);
    if (!buses) return context.fail_with({program::kExitFailure, "neither HOME nor XDG_CONFIG_HOME is set"});
    if (options.action == "list") return list_contexts(*buses, options.output, context);
    const bool needs_name = options.action != "use";
    if (needs_name && options.name.empty())
        return context.fail_with(
            {program::kExitUsage, "which one? asipctl context " + options.action + " NAME"});
    const auto done = options.action == "add"   ? add_context(options, *buses, context)
                      : options.action == "use" ? buses->use(options.name)
                                                : buses->remove(options.name);
    if (!done)
        return context.fail_with(
            {options.action == "add" ? program::kExitUsage : program::kExitFailure, done.error()});
    if (options.action == "add" && buses->names().size() == 1)
        context.note("now: asipctl context use " + options.name);
    return program::kExitOk;
}

Run declare_context(Declaration& verb) {
    auto options = std::make_shared<ContextOptions>();
    verb.argument("list|add|use|remove", options->action, "What to do; default list",
                  Declaration::Needed::kNo);
    verb.argument("NAME", options->name, "Which; `use` without one: none", Declaration::Needed::kNo);
    verb.argument("ADDRESS", options->address, "Of the broker, for `add`", Declaration::Needed::kNo);
    verb.output(options->output, {Output::kTable, Output::kName}, {"name", "broker", "user", "current"});
    return [options](Context& context) { return run_context(*options, context); };
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
        declare_context, false};
}

}  // namespace asip::cli
