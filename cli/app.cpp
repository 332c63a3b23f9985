#include "cli/app.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cctype>
#include <cstdlib>
#include <optional>
#include <ostream>
#include <set>

#include "asip/program/options.hpp"
#include "asip/text/duration.hpp"
#include "cli/command.hpp"
#include "cli/commands/completion.hpp"
#include "cli/context.hpp"
#include "cli/terminal.hpp"

namespace asip::cli {
namespace {

constexpr char kMark = '\x01';
/// A registry's answer may hold a thousand boards with their descriptions.
constexpr std::uint32_t kMaxAnswerBytes = 64u << 20;

struct CommonOptions {
    program::BrokerOptions broker;
    program::LogOptions log{.level = "warning", .format = "text"};
    std::string timeout = "5s";
    std::string services;
    std::string colour = "auto";
    bool from_bus = false;
};

void add_common_options(CLI::App& app, program::Settings& settings, CommonOptions& options) {
    settings.add_broker_options(options.broker);
    settings.add_log_options(options.log);
    settings.setting(
        app.add_option("--services", options.services, "Folder of service models besides the built-in ones")
            ->check(CLI::ExistingDirectory)
            ->type_name("DIR"));
    settings.setting(app.add_option("--timeout", options.timeout, "How long to wait for one answer")
                         ->capture_default_str()
                         ->type_name("DURATION"));
    settings.setting(app.add_option("--color", options.colour, "auto, always or never; NO_COLOR is respected")
                         ->check(CLI::IsMember({"auto", "always", "never"}))
                         ->capture_default_str()
                         ->type_name("WHEN"));
    settings.setting(
        app.add_flag("--from-bus", options.from_bus, "Do not ask a registry, read the bus itself"));
}

std::optional<std::string> environment(const std::string& name) {
    const char* value = std::getenv(name.c_str());
    return value == nullptr ? std::nullopt : std::optional<std::string>(value);
}

Outcome<void> apply(const CommonOptions& options, Context& context) {
    auto mqtt = program::mqtt_options(options.broker, "asipctl");
    if (!mqtt) return failure(program::kExitUsage, mqtt.error());
    context.mqtt = std::move(*mqtt);
    context.mqtt.max_packet_bytes = kMaxAnswerBytes;
    context.topics = bus::Topics(options.broker.topic_root);
    const auto timeout = text::parse_duration(options.timeout);
    if (!timeout) return failure(program::kExitUsage, "--timeout: " + timeout.error());
    context.timeout = *timeout;
    context.mqtt.connect_timeout = *timeout;
    context.from_bus = options.from_bus;
    if (!options.services.empty()) {
        auto& models = context.own_models.emplace(model::ModelSet::standard());
        if (const auto loaded = models.load_directory(options.services); !loaded) {
            return failure(program::kExitUsage, loaded.error());
        }
    }
    return {};
}

ColourChoice colour_choice(const std::string& word) {
    return word == "always"  ? ColourChoice::kAlways
           : word == "never" ? ColourChoice::kNever
                             : ColourChoice::kAuto;
}

/// What `__complete AT WORD...` asks for; the options that say where the bus is stay with the program.
struct CompletionRequest {
    std::size_t at = 0;
    std::vector<std::string> words;
    std::vector<std::string> arguments{"asipctl"};
};

CompletionRequest completion_request(int argc, const char* const* argv) {
    CompletionRequest request;
    request.at = argc > 2 ? static_cast<std::size_t>(std::strtoul(argv[2], nullptr, 10)) : 0;
    request.words.assign(argv + std::min(argc, 3), argv + argc);
    const std::set<std::string> of_bus{"--broker", "--topic-root", "--user", "--password-file",
                                       "--ca",     "--cert",       "--key",  "--config"};
    for (std::size_t i = 0; i < request.words.size();) {
        const bool has_value = i + 1 < request.words.size() && i + 1 != request.at;
        if (of_bus.count(request.words[i]) == 0 || !has_value || i + 1 >= request.at) {
            ++i;
            continue;
        }
        request.arguments.insert(request.arguments.end(), {request.words[i], request.words[i + 1]});
        request.words.erase(request.words.begin() + static_cast<std::ptrdiff_t>(i),
                            request.words.begin() + static_cast<std::ptrdiff_t>(i) + 2);
        request.at -= 2;
    }
    request.arguments.emplace_back("completion");
    request.arguments.emplace_back("bash");
    return request;
}

std::vector<CommandShape> shapes(const CLI::App& app) {
    std::vector<CommandShape> result;
    for (const auto* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        CommandShape shape{command->get_name(), {}, {}};
        for (const auto* owner : {command, &app}) {
            for (const auto* option : owner->get_options()) {
                std::vector<std::string> names;
                for (const auto& name : option->get_lnames())
                    names.push_back("--" + name);
                for (const auto& name : option->get_snames())
                    names.push_back("-" + name);
                shape.options.insert(shape.options.end(), names.begin(), names.end());
                if (option->get_items_expected_min() == 0) continue;
                shape.options_of_value.insert(shape.options_of_value.end(), names.begin(), names.end());
            }
        }
        result.push_back(std::move(shape));
    }
    return result;
}

}  // namespace

std::vector<std::string> mark_negative_numbers(int argc, const char* const* argv) {
    std::vector<std::string> result(argv, argv + argc);
    for (std::size_t i = 1; i < result.size(); ++i) {
        const auto& argument = result[i];
        const bool number = argument.size() > 1 && argument[0] == '-' &&
                            std::isdigit(static_cast<unsigned char>(argument[1]));
        if (number) result[i] = kMark + argument;
    }
    return result;
}

void unmark(std::string& argument) {
    if (!argument.empty() && argument.front() == kMark) argument.erase(0, 1);
}

int run_app(int argc, const char* const* argv, std::istream& in, std::ostream& out, std::ostream& err) {
    CLI::App app{
        "Lists, watches, reads and commands boards on the ASIP service bus.\n"
        "Data goes to standard output, everything else to standard error.",
        "asipctl"};
    app.require_subcommand(1);
    app.footer(
        "Exit status: 0 ok, 1 it did not succeed, 2 usage, 3 broker not reachable or it refused us,\n"
        "4 nothing answered in time.\n"
        "Examples:\n"
        "  asipctl list\n"
        "  asipctl show uno1/servo\n"
        "  asipctl subscribe uno1/distance\n"
        "  asipctl send uno1/servo write 0 90\n"
        "  asipctl pin uno1 13 high");
    CommonOptions options;
    program::Settings settings(app, "asipctl");
    add_common_options(app, settings, options);
    Chosen chosen;
    for (auto* setup : {setup_list, setup_show, setup_subscribe, setup_send, setup_pin, setup_ping, setup_top,
                        setup_doctor, setup_forget, setup_prune, setup_completion}) {
        setup(app, chosen);
    }

    std::optional<CompletionRequest> completion;
    if (argc > 1 && std::string_view(argv[1]) == "__complete") completion = completion_request(argc, argv);
    const auto arguments = completion ? completion->arguments : mark_negative_numbers(argc, argv);
    std::vector<const char*> pointers;
    for (const auto& argument : arguments)
        pointers.push_back(argument.c_str());
    if (const auto status = settings.parse(static_cast<int>(pointers.size()), pointers.data()))
        return *status;

    Context context{in, out, err};
    if (const auto applied = apply(options, context); !applied) return context.fail_with(applied.error());
    context.width = terminal_width(STDOUT_FILENO);
    context.colour = use_colour(colour_choice(options.colour), context.terminal(), environment);
    if (completion) return run_complete(completion->words, completion->at, shapes(app), context);
    return chosen(context);
}

}  // namespace asip::cli
