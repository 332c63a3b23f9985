// SPDX-License-Identifier: Apache-2.0
#include "agent/options.hpp"

#include <CLI/CLI.hpp>
#include <chrono>
#include <ctime>
#include <iostream>

#include "agent/label_files.hpp"
#include "asip/bus/topics.hpp"
#include "asip/link/tcp_stream.hpp"
#include "asip/model/names.hpp"
#include "asip/program/exit_status.hpp"
#include "asip/program/options.hpp"
#include "asip/text/duration.hpp"

namespace asip::agent {

namespace {

constexpr const char* kAbout =
    "Puts one ASIP board on the service bus: announces it with its services, bridges its events and "
    "commands,\n"
    "and keeps doing so when the board or the broker leaves and comes back.";

constexpr const char* kExamples =
    "Examples:\n"
    "  asip-agent --serial /dev/ttyACM0\n"
    "      The board at that port, to the broker on this machine, under the name stored on the board.\n"
    "  asip-agent --serial /dev/ttyUSB0 --name greenhouse --broker broker.local,backup.local\n"
    "      Two brokers: the second is used while the first does not answer.\n"
    "  asip-agent --tcp 192.168.1.20:5005 --broker mqtts://broker.local --user pi --password-file ~/.asip\n"
    "      A board with a network of its own; encrypted to the broker.\n"
    "  asip-agent --serial /dev/ttyACM0 --label room=lab,floor=2\n"
    "      Labels by which asipctl and programs choose boards.\n"
    "  asip-agent --serial /dev/ttyACM0 --reports on-demand --resting-period 10s\n"
    "      Values as often as somebody wants them, and one in 10 s while nobody does.\n"
    "  asip-agent --serial /dev/ttyACM0 --listen 6789\n"
    "      Clients without MQTT may connect to port 6789, with plain lines or Java's writeUTF frames.\n"
    "\n"
    "Exit status: 0 stopped by a signal; 2 bad option; 3 the broker refused the connection; 5 port busy, no "
    "permission, or no "
    "ASIP\n"
    "board there; 6 another agent holds the board's name.";

struct Raw {
    program::BrokerOptions broker;
    program::LogOptions log;
    std::vector<std::string> listen;
    std::vector<std::string> labels;
    std::string state_dir;
    std::string listen_silence = "2s", statistics = "15s";
    std::string reports = "always", fastest_period = "20ms", resting_period = "0s";
    std::string name, serial, tcp, services, reset = "if-silent", terminator;
    std::string topics = "board-side";
    unsigned baud = 57600;
    unsigned max_baud = 1'000'000;
    bool no_step_up = false;
    bool takeover = false;
    bool retain_values = false;
    bool keep_outputs = false;
    bool checksum = false;
    int lease = model::kDefaultLeaseSeconds;
    double patience = 8;
};

void declare(CLI::App& app, program::Settings& settings, Raw& raw) {
    settings.setting(app.add_option("--serial", raw.serial, "Serial port of the board, e.g. /dev/ttyACM0")
                         ->group("Board"));
    settings.setting(app.add_option("--tcp", raw.tcp, "HOST:PORT of a board with a network")->group("Board"));
    settings.setting(
        app.add_option("--name", raw.name,
                       "Name of the board on the bus; default: stored on the board, else from the port")
            ->group("Board"));
    settings.setting(
        app.add_option("--label", raw.labels,
                       "KEY=VALUE, pin.N=NAME or SERVICE/name=NAME: what to call the board by. Not "
                       "to be changed over the bus. Several: separated by commas, or several times")
            ->delimiter(',')
            ->group("Board"));
    settings.setting(app.add_option("--state-dir", raw.state_dir,
                                    "Folder to keep labels in that are set over the bus; default: "
                                    "$STATE_DIRECTORY, $XDG_STATE_HOME/asip or ~/.local/state/asip")
                         ->group("Board"));
    settings.setting(app.add_flag("--takeover", raw.takeover,
                                  "Take the name even if another agent holds it; that one ends")
                         ->group("Board"));
    settings.setting(
        app.add_option("--reset", raw.reset, "Whether to restart the board by DTR when its port was opened")
            ->check(CLI::IsMember({"never", "always", "if-silent"}))
            ->capture_default_str()
            ->group("Board"));
    settings.setting(app.add_option("--baud", raw.baud, "Rate of the line at the start")
                         ->check(CLI::Range(300, 4'000'000))
                         ->capture_default_str()
                         ->group("Board"));
    settings.setting(app.add_option("--max-baud", raw.max_baud, "Highest rate to step the line up to")
                         ->capture_default_str()
                         ->group("Board"));
    settings.setting(
        app.add_flag("--no-step-up", raw.no_step_up, "Leave the rate of the line alone")->group("Board"));
    settings.setting(
        app.add_flag(
               "--checksum", raw.checksum,
               "Put a checksum on each line from the start, where the board can; default: on fast lines, "
               "and once the line is damaged")
            ->group("Board"));
    settings.setting(app.add_flag("--keep-outputs", raw.keep_outputs,
                                  "Leave motors and other actuators as they are found at the start; "
                                  "default: stop them")
                         ->group("Board"));
    settings.setting(app.add_option("--patience", raw.patience,
                                    "Seconds without any answer after which this is not an ASIP board")
                         ->check(CLI::Range(0.1, 3600.0))
                         ->capture_default_str()
                         ->group("Board"));
    settings.setting(app.add_option("--services", raw.services, "Folder of further service models (*.json)")
                         ->group("Bus"));
    settings.setting(app.add_option("--lease", raw.lease, "Seconds for which an announcement holds")
                         ->check(CLI::Range(3, model::kMaxLeaseSeconds))
                         ->capture_default_str()
                         ->group("Bus"));
    settings.setting(
        app.add_option("--statistics", raw.statistics, "How often to publish what was counted; 0s: never")
            ->capture_default_str()
            ->group("Bus"));
    settings.setting(
        app.add_option("--reports", raw.reports,
                       "on-demand: set the periods of services to what subscribers demand, and stop them "
                       "when nobody does. Plain MQTT clients demand nothing: see --resting-period")
            ->check(CLI::IsMember({"always", "on-demand"}))
            ->capture_default_str()
            ->group("Bus"));
    settings.setting(app.add_option("--resting-period", raw.resting_period,
                                    "With --reports on-demand: period where nobody demands; 0s: no reports")
                         ->capture_default_str()
                         ->group("Bus"));
    settings.setting(app.add_option("--fastest-period", raw.fastest_period,
                                    "With --reports on-demand: shortest period that demands can bring about")
                         ->capture_default_str()
                         ->group("Bus"));
    settings.setting(
        app.add_option(
               "--topics", raw.topics,
               "Whose side the topics BOARD/in and BOARD/out of raw lines are named from. client-side: "
               "requests come on BOARD/out and lines of the board go to BOARD/in, for newer python-asip")
            ->check(CLI::IsMember({"board-side", "client-side"}))
            ->capture_default_str()
            ->group("Bus"));
    settings.setting(
        app.add_option("--line-terminator", raw.terminator,
                       "What ends each raw line: none, or lf with --topics client-side, unless given")
            ->check(CLI::IsMember({"none", "lf", "crlf"}))
            ->group("Bus"));
    settings.setting(
        app.add_flag("--retain-values", raw.retain_values, "Retain the last value of each service")
            ->group("Bus"));
    settings.setting(
        app.add_option(
               "--listen", raw.listen,
               "[HOST:]PORT[/lines|/frames] for point-to-point clients; 127.0.0.1 if no host. Several "
               "addresses: separated by commas, or several times")
            ->delimiter(',')
            ->group("Point to point"));
    settings.setting(app.add_option("--listen-silence", raw.listen_silence,
                                    "A client that sent nothing for so long gets plain lines")
                         ->capture_default_str()
                         ->group("Point to point"));
}

Expected<ListenAddress> parse_listen(std::string_view text) {
    using Kind = ClientFraming::Kind;
    ListenAddress listen;
    if (text.starts_with("tcp://")) text.remove_prefix(6);
    if (const auto slash = text.rfind('/'); slash != std::string_view::npos && !text.ends_with("/")) {
        const auto framing = text.substr(slash + 1);
        if (framing != "lines" && framing != "frames")
            return fail("\"" + std::string(framing) + "\" is neither lines nor frames");
        listen.framing = framing == "lines" ? Kind::kLines : Kind::kFrames;
        text = text.substr(0, slash);
    }
    auto address = link::parse_tcp_address(text, "127.0.0.1");
    if (!address) return fail(address.error());
    listen.address = std::move(*address);
    return listen;
}

Expected<model::Labels> parse_labels(const std::vector<std::string>& texts) {
    model::LabelChange change;
    for (const auto& text : texts) {
        if (text.find('=') == std::string::npos) return fail("\"" + text + "\" is not KEY=VALUE");
        if (const auto added = model::add_assignment(change, text); !added) return fail(added.error());
    }
    return model::changed({}, change);
}

Expected<ReportOptions> report_options(const Raw& raw) {
    using std::chrono::milliseconds;
    constexpr milliseconds kSlowest{65535};
    ReportOptions options;
    options.on_demand = raw.reports == "on-demand";
    for (const auto& [name, text, least, period] :
         {std::tuple{"--resting-period", &raw.resting_period, milliseconds{0}, &options.resting},
          std::tuple{"--fastest-period", &raw.fastest_period, milliseconds{1}, &options.fastest}}) {
        const auto given = text::parse_duration(*text);
        if (!given) return fail(std::string(name) + ": " + given.error());
        *period = std::chrono::duration_cast<milliseconds>(*given);
        if (*period < least || *period > kSlowest)
            return fail(std::string(name) + ": " + *text + " is not " + std::to_string(least.count()) +
                        " ms to 65535 ms, for example 100ms");
    }
    return options;
}

Unexpected<int> usage_error(const std::string& text) {
    std::cerr << "asip-agent: " << text << "\n";
    return Unexpected<int>(program::kExitUsage);
}

}  // namespace

Expected<AgentOptions, int> read_options(int argc, const char* const* argv) {
    Raw raw;
    CLI::App app{kAbout, "asip-agent"};
    app.footer(kExamples);
    program::Settings settings(app, "asip-agent");
    declare(app, settings, raw);
    settings.add_broker_options(raw.broker);
    settings.add_credentials_dir(raw.broker);
    settings.add_log_options(raw.log);
    if (const auto status = settings.parse(argc, argv)) return Unexpected<int>(*status);

    AgentOptions options;
    if (raw.serial.empty() == raw.tcp.empty())
        return usage_error(
            "say where the board is: --serial PORT or --tcp HOST:PORT (one of them). --help has examples");
    if (!raw.name.empty() && !model::valid_board_name(raw.name))
        return usage_error("--name: " + model::explain_board_name(raw.name) + "; for example --name " +
                           model::suggest_name(raw.name));
    if (!raw.tcp.empty())
        if (const auto address = link::parse_tcp_address(raw.tcp); !address)
            return usage_error("--tcp: " + address.error());
    for (const std::string& text : raw.listen) {
        auto listen = parse_listen(text);
        if (!listen) return usage_error("--listen: " + listen.error());
        options.listen.push_back(std::move(*listen));
    }
    const auto silence = text::parse_duration(raw.listen_silence);
    if (!silence) return usage_error("--listen-silence: " + silence.error());
    options.listen_silence = *silence;
    const auto statistics = text::parse_duration(raw.statistics);
    if (!statistics) return usage_error("--statistics: " + statistics.error());
    options.statistics = *statistics;
    const auto reports = report_options(raw);
    if (!reports) return usage_error(reports.error());
    options.bridge.reports = *reports;
    auto mqtt = program::mqtt_options(raw.broker, "asip-agent");
    if (!mqtt) return usage_error(mqtt.error());
    options.mqtt = std::move(*mqtt);
    options.broker = raw.broker;
    options.models = model::ModelSet::standard();
    if (!raw.services.empty())
        if (const auto loaded = options.models.load_directory(raw.services); !loaded)
            return usage_error("--services: " + loaded.error());

    auto labels = parse_labels(raw.labels);
    if (!labels) return usage_error("--label: " + labels.error());
    options.bridge.labels = std::move(*labels);
    options.state_folder =
        raw.state_dir.empty() ? default_state_folder() : std::filesystem::path(raw.state_dir);

    options.serial = raw.serial;
    options.tcp = raw.tcp;
    options.baud = raw.baud;
    options.reset = raw.reset == "never"    ? ResetPolicy::kNever
                    : raw.reset == "always" ? ResetPolicy::kAlways
                                            : ResetPolicy::kIfSilent;
    options.bridge.topic_root = raw.broker.topic_root;
    options.bridge.name = raw.name;
    options.bridge.keep_outputs = raw.keep_outputs;
    options.bridge.lease_seconds = raw.lease;
    options.bridge.takeover = raw.takeover;
    options.bridge.started_unix = static_cast<std::uint64_t>(std::time(nullptr));
    // A broker that knows its users may have rules for them.
    options.bridge.on_shared_topic = options.mqtt.user.empty() && options.mqtt.cert_file.empty();
    options.bridge.session.max_baud = raw.no_step_up ? 0 : raw.max_baud;
    if (raw.checksum) options.bridge.session.checksum = session::ChecksumPolicy::kAlways;
    options.bridge.session.patience =
        std::chrono::duration_cast<Duration>(std::chrono::duration<double>(raw.patience));
    options.bridge.context.client_side = raw.topics == "client-side";
    if (raw.terminator.empty()) raw.terminator = options.bridge.context.client_side ? "lf" : "none";
    options.bridge.context.terminator = raw.terminator == "lf"     ? "\n"
                                        : raw.terminator == "crlf" ? "\r\n"
                                                                   : "";
    options.bridge.context.retain_values = raw.retain_values;
    return options;
}

}  // namespace asip::agent
