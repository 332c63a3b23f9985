// SPDX-License-Identifier: Apache-2.0
#include "agent/program/option_checks.hpp"

#include <chrono>
#include <ctime>
#include <filesystem>

#include "agent/cable/cables.hpp"
#include "agent/describe/label_files.hpp"
#include "agent/program/options.hpp"
#include "asip/bus/topics.hpp"
#include "asip/link/tcp_stream.hpp"
#include "asip/model/names.hpp"
#include "asip/text/duration.hpp"
#include "asip/text/printable.hpp"

namespace asip::agent {

namespace {

constexpr std::size_t kLastPort = 65535;

/// HOST:PORT, with how lines are framed there: HOST:PORT/frames, HOST:PORT/lines.
Expected<ListenAddress> parse_framed_address(std::string_view text, std::string_view default_host) {
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
    auto address = link::parse_tcp_address(text, default_host);
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

Expected<ReportOptions> report_options(const RawOptions& raw) {
    using std::chrono::milliseconds;
    constexpr milliseconds kSlowest{65535};
    ReportOptions options;
    options.on_demand = raw.reports != "always";
    options.shared = raw.reports == "shared";
    for (const auto& [name, text, least, period] :
         {std::tuple{"resting-period", &raw.resting_period, milliseconds{0}, &options.resting},
          std::tuple{"fastest-period", &raw.fastest_period, milliseconds{1}, &options.fastest}}) {
        const auto given = text::parse_duration(*text);
        if (!given) return fail(std::string(name) + ": " + given.error());
        *period = std::chrono::duration_cast<milliseconds>(*given);
        if (*period < least || *period > kSlowest)
            return fail(std::string(name) + ": " + *text + " is not " + std::to_string(least.count()) +
                        " ms to 65535 ms, for example 100ms");
    }
    return options;
}

/// A name of udev for a port stands for its path, as the service gives it: by-id names begin with their bus,
/// by-path ones with the controller.
std::string port_path(const std::string& port) {
    if (port.find('/') != std::string::npos) return port;
    if (port.starts_with("usb-")) return "/dev/serial/by-id/" + port;
    return port.find("-usb-") != std::string::npos ? "/dev/serial/by-path/" + port : port;
}

// What can be no port of this machine, however long one waits for it; empty: it may be one.
std::string serial_fault(const std::string& port) {
    if (const auto scheme = port.find("://"); scheme != std::string::npos)
        return "\"" + text::without_credentials(port) +
               "\" is no port; for a board with a network give --tcp " +
               text::without_credentials(port).substr(scheme + 3);
    const bool windows = port.size() > 3 && (port.starts_with("COM") || port.starts_with("com")) &&
                         port.find_first_not_of("0123456789", 3) == std::string::npos;
    if (windows)
        return port +
               " is how Windows calls a port; here look into /dev/serial/by-id, or for /dev/ttyACM0 and "
               "/dev/ttyUSB0";
    std::error_code error;
    if (!port.empty() && port.find('/') == std::string::npos && !std::filesystem::exists(port, error))
        return "\"" + port + "\" is no path; is it /dev/" + port + "?";
    if (std::filesystem::is_directory(port, error))
        return port + " is a folder; name a port, for example one in /dev/serial/by-id";
    const auto behind = port.find_last_of(":,@ ");
    const bool with_rate = behind != std::string::npos && behind + 1 < port.size() &&
                           port.find_first_not_of("0123456789", behind + 1) == std::string::npos &&
                           port.find('/', behind) == std::string::npos;
    // Names of by-path have colons, too; those are there, or will be.
    if (with_rate && port.starts_with("/dev/tty"))
        return port + ": a rate is given by --baud " + port.substr(behind + 1) + ", behind --serial " +
               port.substr(0, behind);
    return {};
}

}  // namespace

Expected<model::ModelSet> load_models(const std::string& folder) {
    auto models = model::ModelSet::standard_and(folder);
    if (!models) return fail("--services: " + models.error());
    return models;
}

Expected<AgentOptions> checked_options(RawOptions raw) {
    AgentOptions options;
    if (!raw.cables.empty()) {
        for (const auto* other : {&raw.serial, &raw.tcp, &raw.name})
            if (!other->empty())
                return fail("--cables: the boards that browsers lend have an agent of their own");
        raw.serial = raw.cables + "/board";
        raw.reset = "never";
        options.bridge.lent = options.bridge.session.opens_for_rate = true;
    }
    if (raw.serial.empty() == raw.tcp.empty())
        return fail(
            "say where the board is: --serial PORT or --tcp HOST:PORT (one of them). --help has examples");
    if (!raw.name.empty() && !model::valid_board_name(raw.name))
        return fail("--name: " + model::explain_board_name(raw.name) + "; for example --name " +
                    model::suggest_name(raw.name));
    raw.serial = port_path(raw.serial);
    if (const auto fault = serial_fault(raw.serial); !fault.empty()) return fail("--serial: " + fault);
    if (!raw.tcp.empty()) {
        auto address = parse_framed_address(raw.tcp, {});
        if (!address) return fail("--tcp: " + address.error());
        if (address->address.port == 0) return fail("--tcp: 0 is not a port (1 to 65535)");
        options.tcp_address = std::move(*address);
    }
    for (const std::string& text : raw.listen) {
        auto listen = parse_framed_address(text, "127.0.0.1");
        if (!listen) return fail("--listen: " + listen.error());
        if (options.bridge.lent && listen->address.port > kLastPort - Cables::kMaxPlaces)
            return fail("--listen: lent boards take " + std::to_string(Cables::kMaxPlaces) +
                        " ports from this one on, and there are " + std::to_string(kLastPort));
        options.listen.push_back(std::move(*listen));
    }
    const auto silence = text::parse_duration(raw.listen_silence);
    if (!silence) return fail("listen-silence: " + silence.error());
    options.listen_silence = *silence;
    const auto statistics = text::parse_duration(raw.statistics);
    if (!statistics) return fail("statistics: " + statistics.error());
    options.statistics = *statistics;
    const auto reports = report_options(raw);
    if (!reports) return fail(reports.error());
    options.bridge.reports = *reports;
    auto mqtt = program::mqtt_options(raw.broker, "asip-agent");
    if (!mqtt) return fail(mqtt.error());
    options.mqtt = std::move(*mqtt);
    options.broker = raw.broker;

    auto labels = parse_labels(raw.labels);
    if (!labels) return fail("--label: " + labels.error());
    options.bridge.labels = std::move(*labels);
    options.state_folder =
        raw.state_dir.empty() ? default_state_folder() : std::filesystem::path(raw.state_dir);

    options.avrdude = raw.avrdude;
    options.firmware_folder = raw.firmware_dir;
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
    options.bridge.on_shared_topic = !options.mqtt.has_user();
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
