// SPDX-License-Identifier: Apache-2.0
#include "cli/command_line.hpp"

#include <algorithm>
#include <array>
#include <iostream>
#include <string_view>
#include <utility>

#include "asip/program/command_words.hpp"
#include "asip/text/duration.hpp"
#include "asip/text/nearest.hpp"
#include "cli/declaration.hpp"
#include "cli/find/broker_search.hpp"
#include "cli/find/user_file.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

constexpr const char* kAbout =
    "Lists, watches, reads and commands boards on the ASIP service bus.\n"
    "Data goes to standard output, everything else to standard error.";

constexpr std::chrono::milliseconds kSearch{1000};

/// `wait --timeout 0` looks once, and still has to get there.
constexpr std::chrono::milliseconds kMinConnectTime{1000};

/// A registry's answer may hold a thousand boards with their descriptions.
constexpr std::uint32_t kMaxAnswerBytes = 64u << 20;

constexpr const char* kNotes =
    "Exit status: 0 done; 1 it did not succeed; 2 wrong use; 3 the broker cannot be reached, refused\n"
    "the connection or was lost; 4 nothing answered in time.\n"
    "Examples:\n"
    "  asipctl list\n"
    "  asipctl show uno1/servo\n"
    "  asipctl subscribe uno1/distance\n"
    "  asipctl send uno1/servo write 0 90\n"
    "  asipctl pin uno1 13 high\n"
    "asipctl help all lists the other commands, too; asipctl COMMAND --help shows the options of one.";

/// What most people type. The others are in `asipctl help all`.
constexpr std::array<std::string_view, 13> kFirst{"list",   "show",   "get",  "subscribe", "send",
                                                  "pin",    "stop",   "open", "label",     "flash",
                                                  "doctor", "secure", "help"};

/// It prints what every verb declares.
bool knows_all(const Verb& verb) {
    return verb.name == "help";
}

const Verb* find_verb(const std::vector<Verb>& verbs, const std::string& name) {
    const auto found =
        std::find_if(verbs.begin(), verbs.end(), [&name](const Verb& verb) { return verb.name == name; });
    return found == verbs.end() ? nullptr : &*found;
}

}  // namespace

CommandLine::CommandLine() : app_(kAbout, "asipctl"), settings_(app_, "asipctl") {
    app_.require_subcommand(1);
    app_.footer(kNotes);
    app_.get_formatter()->label("SUBCOMMAND", "COMMAND");
    app_.get_formatter()->label("Subcommands", "Commands");
    add_common_options();
}

CommandLine::CommandLine(const std::vector<Verb>& verbs) : CommandLine() {
    for (const auto& verb : verbs)
        add_verb(verb, true);
}

CommandLine::CommandLine(const std::vector<Verb>& verbs, const std::vector<std::string>& arguments)
    : CommandLine() {
    const auto* verb = find_verb(verbs, first_argument(arguments));
    const bool alone = verb != nullptr && !knows_all(*verb);
    for (const auto& one : verbs)
        if (!alone || &one == verb) add_verb(one, verb != nullptr);
}

std::string CommandLine::first_argument(const std::vector<std::string>& words) const {
    const auto read = program::classify(app_, words);
    for (std::size_t i = 0; i < words.size(); ++i)
        if (read[i].kind == program::CommandWord::Kind::kArgument) return words[i];
    return {};
}

void CommandLine::add_verb(const Verb& verb, bool with_options) {
    auto* command = app_.add_subcommand(verb.name, verb.summary);
    command->fallthrough();
    const bool first = std::find(kFirst.begin(), kFirst.end(), verb.name) != kFirst.end();
    command->group(first ? "Commands" : "");
    if (!with_options) return;
    command->footer(verb.notes + "\nOptions of every command: asipctl --help");
    Declaration declaration(*command);
    command->callback([this, run = verb.declare(declaration), uses_bus = verb.uses_bus] {
        chosen_ = run;
        uses_bus_ = uses_bus;
    });
}

void CommandLine::add_common_options() {
    settings_.add_broker_options(broker_);
    settings_.add_log_options(log_);
    settings_.setting(
        app_.add_option("--services", services_, "Folder of service models besides the built-in ones")
            ->check(CLI::ExistingDirectory.description(""))
            ->type_name("DIR"));
    settings_.setting(app_.add_option("--timeout", timeout_, "How long to wait for one answer")
                          ->capture_default_str()
                          ->type_name("DURATION"));
    program::one_of(
        settings_.setting(app_.add_option(
            "--color", colour_, "When to use colours; auto: on a terminal, unless NO_COLOR is set")),
        {"auto", "always", "never"})
        ->capture_default_str();
    settings_
        .setting(app_.add_flag("--no-mdns", no_mdns_,
                               "Do not search the local network for a broker where none is configured"))
        ->group("Broker");
    settings_.setting(app_.add_flag("--from-bus", from_bus_, "Do not ask a registry, read the bus itself"));
}

// CLI11 has no place for words behind `--` once a verb has the arguments that it needs.
std::vector<std::string> CommandLine::arguments_last(std::vector<std::string> words) const {
    if (std::find(words.begin(), words.end(), "--") == words.end()) return words;
    const auto read = program::classify(app_, words);
    std::vector<std::string> result, arguments;
    bool only_arguments = false;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const bool argument = read[i].kind == program::CommandWord::Kind::kArgument;
        const bool value = read[i].kind == program::CommandWord::Kind::kValue;
        if (words[i] == "--" && !argument && !value && !std::exchange(only_arguments, true)) continue;
        (argument ? arguments : result).push_back(std::move(words[i]));
    }
    if (only_arguments) result.push_back("--");
    result.insert(result.end(), arguments.begin(), arguments.end());
    return result;
}

/// A verb that users of other programs type first, or that had a name of its own, and what does it here.
std::optional<std::string> CommandLine::usual_name(const std::vector<std::string>& words) const {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 13> kNames{
        {{"ls", "list"},
         {"devices", "list"},
         {"boards", "list"},
         {"watch", "subscribe"},
         {"rm", "forget"},
         {"mv", "label BOARD name=NAME"},
         {"rename", "label BOARD name=NAME"},
         {"set", "send"},
         {"history", "events BOARD --last 20"},
         {"logs", "events --logs"},
         {"models", "model"},
         {"explain", "model KIND"},
         {"prune", "forget --leftovers"}}};
    const auto read = program::classify(app_, words);
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (read[i].kind != program::CommandWord::Kind::kUnknownSubcommand) continue;
        for (const auto& [usual, ours] : kNames)
            if (words[i] == usual)
                return "there is no command \"" + words[i] + "\"; try asipctl " + std::string(ours);
        break;
    }
    return std::nullopt;
}

std::optional<int> CommandLine::parse(std::vector<std::string> arguments) {
    if (const auto usual = usual_name(arguments)) return settings_.usage_error(*usual);
    arguments = arguments_last(std::move(arguments));
    typed_ = typed_options(arguments);
    const auto typed = arguments.size();
    auto all = with_user_file(std::move(arguments), program::environment_variable);
    if (!all) return settings_.usage_error(all.error());
    const bool more = all->size() > typed;
    const auto ended = settings_.parse(std::move(*all));
    if (more && ended == program::kExitUsage)
        std::cerr << "Options are also in " << user_file(program::environment_variable)->string()
                  << std::endl;
    return ended;
}

OptionValues CommandLine::typed_options(const std::vector<std::string>& words) const {
    const auto read = program::classify(app_, words);
    const auto own = app_.get_options();
    OptionValues result;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const auto* option = read[i].option;
        const bool common = option != nullptr && std::find(own.begin(), own.end(), option) != own.end();
        if (read[i].kind != program::CommandWord::Kind::kOption || !common) continue;
        if (option->get_lnames().empty() || words[i] == "--help" || words[i] == "--version") continue;
        const auto equals = words[i].find('=');
        const bool value_follows =
            i + 1 < words.size() && read[i + 1].kind == program::CommandWord::Kind::kValue;
        if (program::takes_value(*option) && equals == std::string::npos && !value_follows) continue;
        const std::string plain = value_follows ? words[i + 1] : "true";  // a flag
        result.emplace_back(option->get_lnames().front(),
                            equals == std::string::npos ? plain : words[i].substr(equals + 1));
    }
    return result;
}

Outcome<void> CommandLine::apply(Environment& environment) const {
    auto mqtt = program::mqtt_options(broker_, "asipctl");
    if (!mqtt) return failure(program::kExitUsage, mqtt.error());
    environment.mqtt = std::move(*mqtt);
    environment.mqtt.max_packet_bytes = kMaxAnswerBytes;
    environment.topics = bus::Topics(broker_.topic_root);
    const auto timeout = text::parse_duration(timeout_);
    if (!timeout) return failure(program::kExitUsage, "--timeout: " + timeout.error());
    environment.timeout = *timeout;
    environment.mqtt.connect_timeout = std::max(*timeout, kMinConnectTime);
    environment.from_bus = from_bus_;
    environment.typed_options = typed_;
    if (!services_.empty()) {
        auto& models = environment.own_models.emplace(model::ModelSet::standard());
        if (const auto loaded = models.load_directory(services_); !loaded)
            return failure(program::kExitUsage, loaded.error());
    }
    return {};
}

Outcome<void> CommandLine::find_broker(Environment& environment) const {
    // Credentials are for the broker that they were made for, and never for one that turns up.
    const bool configured = broker_.brokers_given || !broker_.credentials.empty() || !broker_.user.empty() ||
                            !broker_.password_file.empty() || !broker_.cert.empty();
    if (!uses_bus_ || no_mdns_ || configured || listens_here(environment.mqtt.brokers.front().port))
        return {};
    const auto found = search_brokers(std::min<Duration>(kSearch, environment.timeout));
    if (found.empty()) {
        environment.note(
            "no broker is configured, none is on this machine, and none is announced on this network");
        return {};
    }
    const auto all = listed(
        found, ", ", [](const auto& broker) { return broker.address.describe() + " (" + broker.name + ")"; });
    if (found.size() > 1)
        return failure(program::kExitBroker, "several brokers are announced on this network: " + all +
                                                 "; choose one: --broker ADDRESS");
    environment.note("no broker is configured: using " + all + ", which is announced on this network");
    environment.mqtt.brokers = {found.front().address};
    // For what we start ourselves.
    environment.typed_options.emplace_back("broker", found.front().address.describe());
    return {};
}

ColourChoice CommandLine::colour() const {
    if (colour_ == "always") return ColourChoice::kAlways;
    return colour_ == "never" ? ColourChoice::kNever : ColourChoice::kAuto;
}

Outcome<std::string> CommandLine::help(const std::string& verb) const {
    // App::help() would print the help of the verb that was given: of `help` itself.
    if (verb.empty() || verb == "all") {
        auto text = app_.get_formatter()->make_help(&app_, "asipctl", CLI::AppFormatMode::Normal);
        return verb.empty() ? text : text + other_commands();
    }
    if (const auto unknown = program::unknown_word(app_, {verb}))
        return failure(program::kExitUsage, *unknown);
    return app_.get_subcommand(verb)->help("asipctl");
}

std::string CommandLine::other_commands() const {
    std::string text = "\nOther commands:\n";
    for (const auto* command :
         app_.get_subcommands([](const CLI::App* each) { return each->get_group().empty(); })) {
        auto line = "  " + command->get_name();
        line.resize(std::max<std::size_t>(line.size() + 2, 30), ' ');
        text += line + command->get_description() + "\n";
    }
    return text;
}

}  // namespace asip::cli
