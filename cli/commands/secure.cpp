// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/secure.hpp"

#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/text/file_text.hpp"
#include "asip/text/wall_time.hpp"
#include "cli/declaration.hpp"
#include "cli/secure/actions.hpp"
#include "cli/secure/check.hpp"
#include "cli/secure/sources.hpp"
#include "cli/secure/system.hpp"
#include "cli/secure/users.hpp"
#include "cli/text/table.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {

namespace {

constexpr auto kSoon = std::chrono::days(60);

std::string day_of(const std::string& iso_time) {
    return iso_time.substr(0, 10);
}

/// One row of the table: a user, or the broker.
struct Row {
    std::string name, role, since, until, file, rights;
};

Row row_of(const SecureFolder& folder, const SecuredUser& user) {
    const auto file = folder.credentials(user.name);
    return {user.name,
            std::string(name_of(user.role)),
            user.made,
            {},
            std::filesystem::exists(file) ? file.string() : std::string(),
            rights_of(user.with_rights()) + (user.boards ? ": those with the labels " + user.selector : "")};
}

Row broker_row(const SecureFolder& folder, const SecuredBus& bus, Environment& environment) {
    const auto hosts = listed(bus.hosts, " ", [&bus](const auto& host) {
        return mqtt::BrokerAddress{host, bus.port, true}.describe();
    });
    Row row{"broker", "broker", {}, {}, folder.certificate().string(), hosts};
    const auto text = text::file_text(folder.certificate());
    const auto end = text ? end_of(*text) : Expected<CertificateTime>(fail("it cannot be read"));
    if (!end) {
        environment.note(folder.certificate().string() + ": " + end.error() +
                         "; asipctl secure init makes one");
        return row;
    }
    row.until = text::iso_time(std::chrono::system_clock::time_point(*end));
    if (*end - std::chrono::system_clock::now() < kSoon)
        environment.note("the broker's certificate ends on " + day_of(row.until) +
                         "; a new one: asipctl secure renew broker");
    return row;
}

/// Prints what each user may do, and until when the broker's certificate is valid.
Outcome<void> secure_show(const SecureOptions& options, Environment& environment) {
    const auto folder = SecureFolder::open(secure_folder(options));
    if (!folder) return tl::unexpected(folder.error());
    const auto bus = folder->bus();
    if (!bus) return tl::unexpected(bus.error());
    std::vector<Row> rows;
    if (options.what.empty())
        rows.push_back(broker_row(*folder, *bus, environment));
    else if (auto known = check_known(*bus, options.what); !known)
        return known;
    for (const auto& user : bus->users)
        if (options.what.empty() || user.name == options.what) rows.push_back(row_of(*folder, user));
    Table table({{"NAME"}, {"ROLE"}, {"SINCE"}, {"UNTIL"}, {"CREDENTIALS HERE"}, {"MAY", false, 20}});
    RecordPrinter records(options.output, RecordPrinter::Count::kList, environment.out);
    for (const auto& row : rows) {
        if (options.output.for_people()) {
            table.add({row.name, row.role, day_of(row.since), day_of(row.until),
                       row.role == "broker" ? ""
                       : row.file.empty()   ? "no"
                                            : "yes",
                       row.rights});
        } else {
            records.print({{"name", row.name},
                           {"role", row.role},
                           {"since", row.since},
                           {"until", row.until},
                           {"file", row.file},
                           {"may", row.rights}});
        }
    }
    if (options.output.for_people())
        environment.out << table.render(environment.width, environment.colour) << std::flush;
    else
        records.finish();
    return {};
}

constexpr std::size_t kDefaultPort = 8883;

/// The first option that was given and that the action does not know; empty: none. What is passed over in
/// silence is done otherwise than it was meant: `add --dry-run` would add.
std::string stray_option(const SecureOptions& options) {
    const auto& action = options.action;
    const bool init = action == "init";
    const bool broker = action == "renew" && options.what == "broker";
    const bool changes_users =
        action == "add" || action == "link" || action == "unlink" || action == "revoke" || action == "renew";
    if (options.dry_run && !init && action != "undo") return "--dry-run";
    if (options.yes && !init) return "--yes";
    if (options.here && action != "add") return "--here";
    if (options.selector && (action != "add" || options.what != "operator")) return "--selector";
    if (!options.hosts.empty() && !init && !broker) return "--host";
    if (options.port != kDefaultPort && !init) return "--port";
    if (!options.mosquitto.empty() && !init) return "--mosquitto";
    if (options.reload_pid && !init && !changes_users) return "--reload-pid";
    return {};
}

}  // namespace

int run_secure(const SecureOptions& options, Environment& environment) {
    if (const auto stray = stray_option(options); !stray.empty())
        return environment.fail_with(
            {program::kExitUsage, "secure " + options.action + " has no " + stray + "; nothing was done"});
    if (options.action == "show") {
        const auto shown = secure_show(options, environment);
        return shown ? program::kExitOk : environment.fail_with(shown.error());
    }
    if (options.action == "check") {
        const auto checked = secure_check(options, environment);
        return checked ? *checked : environment.fail_with(checked.error());
    }
    SecureReport report(options.output, environment);
    const auto done = options.action == "init"  ? secure_init(options, environment, report)
                      : options.action == "add" ? secure_add(options, environment, report)
                      : options.action == "link" || options.action == "unlink" ? secure_link(options, report)
                      : options.action == "undo"   ? secure_undo(options, environment, report)
                      : options.action == "revoke" ? secure_revoke(options, environment, report)
                                                   : secure_renew(options, report);
    report.finish();
    return done ? program::kExitOk : environment.fail_with(done.error());
}

namespace {

constexpr std::size_t kMaxPort = 65535;

Run declare_secure(Declaration& verb) {
    auto options = std::make_shared<SecureOptions>();
    verb.argument("init|add|link|unlink|revoke|renew|show|check|undo", options->action, "What to do");
    verb.argument("board|operator|viewer|registry|gateway|admin|broker|...", options->what,
                  "add: the role; link, unlink: a board; revoke, renew, show, check: a name (renew broker: "
                  "its certificate)",
                  Declaration::Needed::kNo);
    verb.arguments(
        "NAME", options->names,
        "add, revoke: names; a board's is that of the board; link, unlink: boards that its agent may hear",
        Declaration::Needed::kNo);
    verb.option("--dir", "DIR", options->folder,
                "Where everything is kept; default: /etc/asip/bus for root, else asip-bus in this folder");
    verb.option(
        "--host", "HOST", options->hosts,
        "init, renew broker: names and addresses by which programs call the broker; default: this machine's");
    verb.option("--port", "PORT", options->port, "init: of the broker, with TLS", 1, kMaxPort);
    verb.option("--mosquitto", "DIR", options->mosquitto,
                "init: folder of the system broker's configuration; default for root: /etc/mosquitto/conf.d");
    verb.option("--reload-pid", "PID", options->reload_pid,
                "Process of the broker that has to read the change; default: found by its pid file");
    verb.option("-l,--selector", "SELECTOR", options->selector,
                "add operator: of the boards that have these labels now, such as class=4b, and no others");
    verb.flag("--here", options->here, "add: for a service or board of this machine, the broker's");
    verb.flag("--yes", options->yes, "init: change the system without a question, for scripts");
    verb.flag("--dry-run", options->dry_run, "init, undo: say what would be done, and do nothing");
    verb.output(
        options->output, {Output::kText},
        {"action", "what", "file", "command", "name", "role", "since", "until", "may", "should", "is"});
    return [options](Environment& environment) { return run_secure(*options, environment); };
}

}  // namespace

Verb secure_verb() {
    return {
        "secure", "Make a bus that lets in only whom you add",
        "init makes an authority, the broker's certificate, configuration and access rules, and an "
        "administrator.\n"
        "On a machine with the services of the packages, init by root secures them and their boards, too.\n"
        "add makes one file for a program on another machine: asip-agent --credentials FILE takes all of "
        "it.\n"
        "init by root says what it changes of the system, and asks; undo takes that back.\n"
        "revoke takes a user out; a running broker drops it at once and keeps all others. check tries at the "
        "running\nbroker what each user may do. Needs no network, overwrites nothing but what renew names, "
        "and can be\nrepeated.\n"
        "Examples:\n"
        "  asipctl secure init --host pi.local\n"
        "  asipctl secure add board uno1\n"
        "  asipctl secure add operator ann\n"
        "  asipctl secure add operator eve -l class=4b\n"
        "  asipctl secure add registry\n"
        "  asipctl secure link lamp desk\n"
        "  asipctl secure revoke uno1\n"
        "  asipctl secure renew ann\n"
        "  asipctl secure show\n"
        "  asipctl secure check",
        declare_secure, false};
}

}  // namespace asip::cli
