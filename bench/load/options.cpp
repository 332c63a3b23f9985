// SPDX-License-Identifier: Apache-2.0
#include "bench/load/options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <fstream>
#include <iostream>

#include "asip/model/names.hpp"
#include "asip/program/command_words.hpp"
#include "asip/program/exit_status.hpp"
#include "asip/program/log.hpp"
#include "asip/program/open_files.hpp"
#include "asip/program/options.hpp"
#include "asip/text/duration.hpp"
#include "bench/load/queries.hpp"

namespace asip::load {
namespace {

namespace log = program::log;

constexpr const char* kAbout =
    "Simulates boards on the bus, by the ten thousand, to find out what a broker and its registries bear.\n"
    "Each is announced as asip-agent announces a board, renews its lease, and answers commands; nothing\n"
    "executes them. Ends with a report.";

constexpr const char* kExamples =
    "Examples:\n"
    "  asip-load --boards 1000 --time 2m --watch\n"
    "      1,000 boards for two minutes; at the end each registry is asked whether it lists them.\n"
    "  asip-load --boards 1000 --time 1m --step '20s die 10%' --step '30s join 10%' --watch\n"
    "      Agents of 100 boards die and are started again.\n"
    "  asip-load --boards 50000 --boards-per-connection 500 --join-rate 2000 --step '1m flap 1% every 60s'\n"
    "      More boards than there are file descriptors, until Ctrl-C; 1 % lose their connection each "
    "minute.\n"
    "  asip-load --boards 200 --values 10 --commands 500 --time 30s -o json\n"
    "      Each service reports ten times a second, and 500 commands a second are sent.\n"
    "  asip-load --boards 500 --queries 200 --watchers 50 --step '30s flap 1% every 10s' --time 1m\n"
    "      What registries bear: 200 questions a second, and 50 programs that follow their changes.\n"
    "\n"
    "Steps: AT VERB BOARDS [over TIME] [down TIME] [every TIME]. AT is a time since the start, or `then`: "
    "once the\nsteps before it are done and all boards are announced (then+5s: so much later). BOARDS is "
    "100, 5% or all. VERB is\n"
    "  join   an agent starts; all do at the start, at --join-rate, unless a step says `0s join ...`\n"
    "  die    the connection breaks for good: the will is published\n"
    "  flap   the connection breaks and comes back after 1s (down TIME)\n"
    "  hang   nothing more is said: the lease runs out\n"
    "  leave  goodbye\n"
    "\n"
    "Exit status: 0 every board was announced, registries agree, and no answer is wrong; 1 not so; 2 bad "
    "option; 3 no broker; 6 the\nnames of boards are held by others.";

// Each connection has its socket, a second name of it, and the two ends by which libmosquitto can be woken.
constexpr std::size_t kFilesOfAConnection = 4;
constexpr std::size_t kOtherFiles = 64;
constexpr std::size_t kMaxBoards = 1'000'000;
constexpr std::size_t kMaxWatchers = 10'000;

struct Raw {
    program::BrokerOptions broker;
    program::LogOptions log;
    std::size_t boards = 100;
    std::size_t per_connection = 0;
    std::string prefix = "load-";
    std::vector<std::string> models{"io", "distance", "servo", "bump", "encoders"};
    int lease = model::kDefaultLeaseSeconds;
    double join_rate = 500;
    std::vector<std::string> steps;
    std::string script, time, settle = "10s";
    bool watch = false;
    double values = 0, commands = 0, queries = 0;
    std::size_t watchers = 0;
    std::string output = "table";
};

void declare_boards(CLI::App& app, program::Settings& settings, Raw& raw) {
    const char* group = "Boards";
    settings.setting(app.add_option("--boards", raw.boards, "How many"))
        ->check(CLI::Range(std::size_t{1}, kMaxBoards))
        ->capture_default_str()
        ->group(group);
    settings
        .setting(app.add_option(
            "--boards-per-connection", raw.per_connection,
            "1: as agents have it, each with a will; more: they share connections, and this program "
            "publishes what the wills would say. Default: 1, or as many as the limit of open files demands"))
        ->check(CLI::Range(1, 100'000))
        ->group(group);
    settings.setting(app.add_option("--prefix", raw.prefix, "What their names begin with; a number follows"))
        ->capture_default_str()
        ->group(group);
    settings
        .setting(app.add_option("--models", raw.models, "Their services, by the names of standard models"))
        ->delimiter(',')
        ->default_str("io,distance,servo,bump,encoders")
        ->group(group);
    settings.setting(app.add_option("--lease", raw.lease, "Seconds for which an announcement holds"))
        ->check(CLI::Range(3, model::kMaxLeaseSeconds))
        ->capture_default_str()
        ->group(group);
    settings.setting(app.add_option("--values", raw.values, "How often a second each service reports"))
        ->check(CLI::Range(0.0, 10'000.0))
        ->capture_default_str()
        ->group(group);
}

void declare_run(CLI::App& app, program::Settings& settings, Raw& raw) {
    const char* group = "Run";
    settings
        .setting(app.add_option("--join-rate", raw.join_rate,
                                "Boards a second that join at the start, unless a step says so"))
        ->check(CLI::Range(0.1, 1e6))
        ->capture_default_str()
        ->group(group);
    settings
        .setting(
            app.add_option("--step", raw.steps, "What happens to them, such as '30s die 5%'; several times"))
        ->allow_extra_args(false)
        ->type_name("STEP")
        ->group(group);
    settings
        .setting(app.add_option("--script", raw.script, "A file of steps, one a line; # begins a comment"))
        ->type_name("FILE")
        ->group(group);
    settings.setting(app.add_option("--time", raw.time, "For how long (30s, 5m); default: until Ctrl-C"))
        ->group(group);
    settings.setting(app.add_option("--commands", raw.commands, "Commands a second that are sent to them"))
        ->check(CLI::Range(0.0, 1e6))
        ->capture_default_str()
        ->group(group);
    settings
        .setting(app.add_option("--queries", raw.queries, "Questions a second that registries are asked"))
        ->check(CLI::Range(0.0, 1e5))
        ->capture_default_str()
        ->group(group);
    settings
        .setting(app.add_option("--watchers", raw.watchers,
                                "Programs that follow the registries' changes, each over its own connection"))
        ->check(CLI::Range(std::size_t{0}, kMaxWatchers))
        ->capture_default_str()
        ->group(group);
    settings
        .setting(
            app.add_flag("--watch", raw.watch,
                         "Listen to the registries, and compare their catalogues with the truth at the end"))
        ->group(group);
    settings
        .setting(app.add_option("--settle", raw.settle,
                                "How long they have for that, and boards, before it, to announce again"))
        ->capture_default_str()
        ->group(group);
    program::one_of(settings.setting(app.add_option("-o,--output", raw.output, "Form of the report")),
                    {"table", "json"})
        ->capture_default_str()
        ->group(group);
}

Unexpected<int> usage(const std::string& text) {
    std::cerr << "asip-load: " << text << "\nTry asip-load --help\n";
    return Unexpected<int>(program::kExitUsage);
}

std::size_t local_ports() {
    std::size_t first = 32768, last = 60999;
    std::ifstream("/proc/sys/net/ipv4/ip_local_port_range") >> first >> last;
    return last > first ? last - first + 1 : 1;
}

Expected<std::size_t> sharing(const Raw& raw) {
    const auto files = program::allow_many_open_files();
    const auto ports = local_ports();
    const std::size_t others = raw.watchers + (raw.queries > 0 ? Queries::kConnections : 0);
    if (kOtherFiles + (others + 1) * kFilesOfAConnection > files || others >= ports)
        return fail("--watchers " + std::to_string(raw.watchers) + ": this machine's limits (" +
                    std::to_string(files) + " open files) do not allow as many; raise them: ulimit -n");
    const auto needed =
        boards_per_connection(raw.boards, files - others * kFilesOfAConnection, ports - others);
    if (raw.per_connection == 0) {
        if (needed > 1)
            log::warning(
                "boards share connections, and have no wills: more would need more open files or ports",
                {{"boards per connection", needed}, {"open files", files}});
        return needed;
    }
    if (raw.per_connection >= needed) return raw.per_connection;
    return fail("--boards-per-connection " + std::to_string(raw.per_connection) + ": for " +
                std::to_string(raw.boards) + " boards this machine's limits (" + std::to_string(files) +
                " open files) need at least " + std::to_string(needed) + "; or raise them: ulimit -n");
}

Expected<std::vector<Step>> steps_of(const Raw& raw) {
    std::vector<Step> steps;
    if (!raw.script.empty()) {
        auto read = read_script(raw.script);
        if (!read) return fail("--script: " + read.error());
        steps = std::move(*read);
    }
    for (const auto& text : raw.steps) {
        const auto step = parse_step(text);
        if (!step) return fail("--step: " + step.error());
        steps.push_back(*step);
    }
    const bool joins_at_start = std::any_of(steps.begin(), steps.end(), [](const Step& step) {
        return step.verb == Verb::kJoin && !step.then && step.at == Duration{};
    });
    if (joins_at_start) return steps;
    Step join;
    join.amount = {0, 1};
    join.over = std::chrono::duration_cast<Duration>(
        std::chrono::duration<double>(static_cast<double>(raw.boards) / raw.join_rate));
    steps.insert(steps.begin(), join);
    return steps;
}

Expected<void> take_time(const Raw& raw, LoadOptions& options) {
    const auto settle = text::parse_duration(raw.settle);
    if (!settle) return fail("--settle: " + settle.error());
    options.settle = *settle;
    if (raw.time.empty()) return {};
    const auto time = text::parse_duration(raw.time);
    if (!time) return fail("--time: " + time.error());
    options.time = *time;
    for (const auto& step : options.steps)
        if (step.at + step.over > *time)
            return fail("--time " + raw.time + " is over before " + std::string(name_of(step.verb)) +
                        " is, which takes until " + text::duration_text(step.at + step.over));
    return {};
}

}  // namespace

std::size_t boards_per_connection(std::size_t boards, std::size_t files, std::size_t ports) {
    const std::size_t by_files = files > kOtherFiles ? (files - kOtherFiles) / kFilesOfAConnection : 1;
    const std::size_t connections = std::max<std::size_t>(1, std::min(by_files, ports * 9 / 10));
    return (boards + connections - 1) / connections;
}

Expected<LoadOptions, int> read_options(int argc, const char* const* argv) {
    CLI::App app{kAbout, "asip-load"};
    app.footer(kExamples);
    program::Settings settings(app, "asip-load");
    Raw raw;
    declare_boards(app, settings, raw);
    declare_run(app, settings, raw);
    settings.add_broker_options(raw.broker);
    settings.add_log_options(raw.log);
    if (const auto status = settings.parse(argc, argv)) return Unexpected<int>(*status);

    LoadOptions options;
    auto& fleet = options.fleet;
    const std::string longest = raw.prefix + std::to_string(kMaxBoards);
    if (!model::valid_board_name(longest)) return usage("--prefix: " + model::explain_board_name(longest));
    auto kind = make_board_kind(raw.models);
    if (!kind) return usage("--models: " + kind.error());
    options.kind = std::move(*kind);
    const bool commandable = std::any_of(options.kind.services.begin(), options.kind.services.end(),
                                         [](const auto& one) { return !one.command.empty(); });
    if (raw.commands > 0 && !commandable) return usage("--commands: no service of --models takes any");
    auto steps = steps_of(raw);
    if (!steps) return usage(steps.error());
    options.steps = std::move(*steps);
    if (const auto taken = take_time(raw, options); !taken) return usage(taken.error());
    auto mqtt = program::mqtt_options(raw.broker, "asip-load");
    if (!mqtt) return usage(mqtt.error());
    fleet.on_shared_topic = !mqtt->has_user();
    fleet.mqtt = std::move(*mqtt);
    const auto shared = sharing(raw);
    if (!shared) return usage(shared.error());
    fleet.per_connection = *shared;
    fleet.topic_root = raw.broker.topic_root;
    fleet.prefix = raw.prefix;
    fleet.boards = raw.boards;
    fleet.lease_seconds = raw.lease;
    fleet.values_per_second = raw.values;
    fleet.started_unix = static_cast<std::uint64_t>(std::time(nullptr));
    options.watch = raw.watch;
    options.commands_per_second = raw.commands;
    options.queries_per_second = raw.queries;
    options.watchers = raw.watchers;
    options.json = raw.output == "json";
    return options;
}

}  // namespace asip::load
