// SPDX-License-Identifier: Apache-2.0
#include "gateway/options.hpp"

#include <algorithm>
#include <iostream>

#include "asip/bus/topics.hpp"
#include "asip/program/app.hpp"
#include "asip/program/exit_status.hpp"
#include "asip/program/options.hpp"
#include "asip/text/duration.hpp"
#include "gateway/export_options.hpp"

namespace asip::gateway {
namespace {

constexpr const char* kAbout =
    "Shows the bus over HTTP: boards, services and values as resources and live streams, a web\n"
    "page to see and move everything, and metrics. Needs no configuration next to the broker.";

constexpr const char* kExamples =
    "Examples:\n"
    "  asip-gateway\n"
    "      For the broker on this machine, at http://127.0.0.1:8080 and from this machine only.\n"
    "  asip-gateway token operator anna --tokens /etc/asip/tokens\n"
    "      Makes a token, prints it once and keeps its hash in the file.\n"
    "  asip-gateway --http 0.0.0.0:8443 --tokens /etc/asip/tokens --http-cert site.pem --http-key site.key\n"
    "      For the whole network, over TLS, for users who have a token.\n"
    "  asip-gateway --home-assistant\n"
    "      Also shows every board to Home Assistant on the same broker.\n"
    "  sudo asip-gateway export home-assistant\n"
    "      The same of the installed service, from now on; --off ends it.\n"
    "  asip-gateway clean home-assistant\n"
    "      Removes from the broker what that left there.\n"
    "  curl http://127.0.0.1:8080/api/boards\n"
    "      Asks it.\n"
    "\n"
    "Exit status: 0 stopped by a signal; 1 failed while running; 2 bad option; 3 the broker refused the "
    "connection.";

struct Raw {
    program::BrokerOptions broker;
    program::LogOptions log;
    std::vector<std::string> http{"127.0.0.1:8080"}, hosts, origins;
    std::string cert, key, tokens, anonymous = "none", loopback, base_path, services, cables;
    std::string forget_after = "7d", idle = "75s", header = "10s", body = "30s";
    bool trusted_proxy = false, no_page = false, no_metrics = false;
    http::ServerLimits limits;
    GatewayOptions gateway;
    ExportOptions exports;
};

void declare_access(program::App& app, program::Settings& settings, Raw& raw) {
    const auto add = [&](const program::Option& option) { return settings.setting(option).group("Access"); };
    add(app.add_option("--tokens", raw.tokens,
                       "File of tokens: lines ROLE NAME HASH; read again when it changes"));
    add(app.add_option("--anonymous", raw.anonymous,
                       "What everybody may do without a token; class: nothing but join a lesson by its code")
            .words({"none", "class", "viewer", "operator"})
            .show_default());
    add(app.add_option("--loopback", raw.loopback,
                       "What programs on this machine may do without a token: none, viewer, operator, admin; "
                       "default: admin without --tokens, none with it or behind a proxy"));
    add(app.add_option("--host", raw.hosts, "Further names under which this gateway is reached").commas());
    add(app.add_option("--allow-origin", raw.origins, "Origins of pages elsewhere that may call the API")
            .commas());
    add(app.add_option("--base-path", raw.base_path, "Path below which a proxy serves it, such as /asip"));
    add(app.add_flag("--trusted-proxy", raw.trusted_proxy,
                     "Connections from this machine are a proxy's: X-Forwarded-For names its clients"));
    add(app.add_option("--http-cert", raw.cert, "TLS: certificate chain, PEM"));
    add(app.add_option("--http-key", raw.key, "TLS: private key, PEM"));
}

void declare_limits(program::App& app, program::Settings& settings, Raw& raw) {
    const auto add = [&](const program::Option& option) {
        settings.setting(option).show_default().group("Limits");
    };
    auto& limits = raw.limits;
    add(app.add_option("--max-connections", limits.connections,
                       "Most connections that are open at once; beyond: 503"));
    add(app.add_option(
        "--max-connections-per-address", limits.connections_per_address,
        "Most connections of one address (of IPv6 one /64) that are open at once; beyond: 503"));
    add(app.add_option(
        "--header-time", raw.header,
        "Longest time in which the head of a request comes, from its first byte; beyond: 408"));
    add(app.add_option(
        "--body-time", raw.body,
        "Longest time in which the body of a request comes, from the end of its head; beyond: 408"));
    add(app.add_option("--idle-time", raw.idle, "How long a connection stays open between two requests"));
    add(app.add_option("--max-streams", raw.gateway.streams_per_client,
                       "Most streams, WebSockets and waits for a value that one client has open at once; "
                       "beyond: 429. A client is a token, or an address without one"));
    add(app.add_option("--max-client-bytes", raw.gateway.client_bytes,
                       "Most memory for all that is kept for one client: its subscriptions, what waits to be "
                       "read by it, and its commands of the last minute; beyond: 429")
            .range(std::size_t{256} << 10, std::size_t{1} << 31));
    add(app.add_option("--commands-per-second", raw.gateway.commands_per_second,
                       "Most commands of one client a second, twice as many at once; beyond: 429")
            .range(0.1, 1e6));
}

void declare(program::App& app, program::Settings& settings, Raw& raw) {
    const auto own = [&](const program::Option& each) { settings.setting(each).group("Gateway"); };
    own(app.add_option("--http", raw.http, "Where to listen: ADDRESS:PORT or unix:PATH; several with commas")
            .commas()
            .show_default());
    own(app.add_option("--services", raw.services, "Folder of further service models (*.json)"));
    own(app.add_option("--cables", raw.cables,
                       "Folder of asip-agent --cables: browsers may lend boards of theirs"));
    own(app.add_option("--forget-after", raw.forget_after,
                       "How long a board that left is shown (90s, 15m, 12h, 7d)")
            .show_default());
    own(app.add_flag("--no-page", raw.no_page, "No web page"));
    own(app.add_flag("--no-metrics", raw.no_metrics, "No /metrics"));
    declare_exports(app, settings, raw.exports);
    declare_access(app, settings, raw);
    declare_limits(app, settings, raw);
    settings.add_broker_options(raw.broker);
    settings.add_credentials_dir(raw.broker);
    settings.add_log_options(raw.log);
    settings.arrange({"http", "cables", "tokens", "anonymous", "http-cert", "http-key", "home-assistant",
                      "homie", "broker", "credentials", "log-level"},
                     {"forget-after",
                      "no-page",
                      "no-metrics",
                      "home-assistant-read-only",
                      "home-assistant-entity-ids",
                      "homie-read-only",
                      "sparkplug-host",
                      "sparkplug-read-only",
                      "no-wot",
                      "export-hz",
                      "loopback",
                      "max-connections",
                      "max-connections-per-address",
                      "header-time",
                      "body-time",
                      "idle-time",
                      "max-streams",
                      "max-client-bytes",
                      "commands-per-second",
                      "mqtt-version",
                      "credentials-dir",
                      "log-format"});
}

program::App declare_token(program::App& app, TokenRequest& token) {
    const auto command =
        app.add_subcommand("token", "Make a token: prints it once, keeps its hash in the file");
    command.add_option("role", token.role, "viewer, operator, operator+raw, admin or kiosk").required();
    command.add_option("name", token.name, "Whose it is: for the log and the history").required();
    command.add_option("--tokens", token.file, "The file of tokens; made where there is none")
        .environment("ASIP_TOKENS")
        .required();
    command.add_option("--until", token.until, "How long it is valid: 12h, 30d");
    command.add_option("--boards", token.boards, "Patterns of the boards that it shows").commas();
    command.add_option("--services", token.services, "Patterns of the services that it shows").commas();
    command.add_option("--frames", token.frames, "Origins whose pages may show a kiosk's").commas();
    command.add_option("--dashboard", token.dashboard, "A kiosk's: it shows this dashboard and nothing else");
    command.add_flag("--control", token.control,
                     "With --dashboard: its switches, sliders and stops may be used, too");
    return command;
}

program::App declare_switch(program::App& app, ExportSwitch& request) {
    const auto command =
        app.add_subcommand("export", "Let the installed service show every board to another system");
    command.add_option("system", request.system, "home-assistant, homie or sparkplug")
        .required()
        .words({"home-assistant", "homie", "sparkplug"});
    command.add_option("value", request.value, "PREFIX, DOMAIN or GROUP[/EDGE], as of the option");
    command.add_flag("--off", request.off, "Not any more");
    command.add_option("--env", request.file, "The file of the service's environment").show_default();
    return command;
}

Unexpected<int> usage(const std::string& text) {
    std::cerr << "asip-gateway: " << text << "\nTry asip-gateway --help\n";
    return Unexpected<int>(program::kExitUsage);
}

bool read_time(const std::string& text, Duration& value, std::string& error, const char* option) {
    const auto parsed = text::parse_duration(text);
    if (!parsed)
        error = std::string(option) + ": " + parsed.error();
    else
        value = *parsed;
    return parsed.has_value();
}

std::string local_name(std::string name) {
    for (char& c : name)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return name;
}

bool is_local(const std::string& address) {
    return address.starts_with("127.") || address.starts_with("[::1]") || address.starts_with("unix:") ||
           address.starts_with("localhost:");
}

}  // namespace

Expected<void> check_access(ProgramOptions& options, const std::string& anonymous,
                            const std::string& loopback, bool behind_proxy) {
    const bool everywhere = !std::all_of(options.addresses.begin(), options.addresses.end(), is_local);
    if (everywhere && options.tokens.empty() && anonymous == "none") {
        return fail(
            "--http is an address that others can reach; choose what each user may do: --tokens FILE (make "
            "tokens with asip-gateway token ROLE NAME), or --anonymous class, viewer or operator for "
            "everybody");
    }
    auto& gate = options.gateway.gate;
    if (anonymous != "none" && anonymous != "class") {
        gate.anonymous = *parse_role(anonymous);
        gate.anonymous.name = "anonymous";
    } else {
        gate.anonymous.name = "nobody";
    }
    const bool closed = behind_proxy || !options.tokens.empty();
    const std::string role = loopback.empty() ? (closed ? "none" : "admin") : loopback;
    if (role != "none") {
        auto rights = parse_role(role);
        if (!rights) return fail("loopback: " + rights.error());
        if (behind_proxy)
            return fail("loopback: behind a proxy everybody seems to be on this machine; leave it out");
        gate.loopback = std::move(*rights);
        gate.loopback.name = "loopback";
    }
    gate.behind_proxy = behind_proxy;
    options.limits.behind_proxy = behind_proxy;
    return {};
}

namespace {

/// Fails with a sentence.
Expected<void> take_options(Raw& raw, const program::App& app, ProgramOptions& options) {
    options.gateway = raw.gateway;
    options.limits = raw.limits;
    options.addresses = raw.http;
    options.tokens = raw.tokens;
    options.services = raw.services;
    options.cables = raw.cables;
    options.http_cert = raw.cert;
    options.http_key = raw.key;
    if (raw.cert.empty() != raw.key.empty()) return fail("--http-cert and --http-key belong together");
    std::string error;
    if (!read_time(raw.forget_after, options.gateway.forget_after, error, "forget-after") ||
        !read_time(raw.idle, options.limits.idle_time, error, "idle-time") ||
        !read_time(raw.header, options.limits.head_time, error, "header-time") ||
        !read_time(raw.body, options.limits.body_time, error, "body-time")) {
        return fail(error);
    }
    options.gateway.page = !raw.no_page;
    options.gateway.metrics = !raw.no_metrics;
    if (!raw.base_path.empty() &&
        (raw.base_path.front() != '/' || raw.base_path.find('/', 1) != std::string::npos ||
         raw.base_path.size() < 2))
        return fail("--base-path: must be one level, such as /asip");
    options.gateway.base_path = raw.base_path;
    const bool unix_only = std::all_of(raw.http.begin(), raw.http.end(), [](const std::string& address) {
        return address.starts_with("unix:");
    });
    if (const auto access = check_access(options, raw.anonymous, raw.loopback,
                                         raw.trusted_proxy || !raw.base_path.empty() || unix_only);
        !access) {
        return fail(access.error());
    }
    auto& hosts = options.gateway.gate.hosts;
    hosts = raw.hosts;
    for (auto& host : hosts)
        host = local_name(host);
    hosts.push_back("localhost");
    hosts.push_back(local_name(program::host_name()));
    hosts.push_back(local_name(program::host_name()) + ".local");
    options.gateway.gate.allowed_origins = raw.origins;
    auto mqtt = program::mqtt_options(raw.broker, "asip-gateway");
    if (!mqtt) return fail(mqtt.error());
    options.mqtt = std::move(*mqtt);
    options.gateway.topic_root = raw.broker.topic_root;
    options.gateway.broker = options.mqtt.brokers.front().describe();
    options.gateway.user = options.mqtt.user;
    options.gateway.client = options.mqtt.client_id;
    return make_exports(raw.exports, app, options);
}

}  // namespace

Expected<CommandLine, int> read_options(int argc, const char* const* argv) {
    program::App app{kAbout};
    app.footer(kExamples);
    program::Settings settings(app, "asip-gateway");
    Raw raw;
    declare(app, settings, raw);
    TokenRequest token;
    const auto make_token = declare_token(app, token);
    ExportSwitch export_switch;
    const auto exporting = declare_switch(app, export_switch);
    std::string dialect;
    const auto clean = app.add_subcommand("clean", "Remove from the broker what an export left there");
    clean.fallthrough();
    clean.add_option("dialect", dialect, "Which; otherwise all")
        .words({"home-assistant", "homie", "sparkplug"});
    if (auto status = settings.parse(argc, argv)) return Unexpected<int>(*status);

    CommandLine result;
    result.clean = clean.parsed();
    if (result.clean) raw.exports.clean = dialect;
    if (make_token.parsed()) {
        result.token = std::make_unique<TokenRequest>(std::move(token));
        return result;
    }
    if (exporting.parsed()) {
        result.export_switch = std::make_unique<ExportSwitch>(std::move(export_switch));
        return result;
    }
    if (const auto taken = take_options(raw, app, result.run); !taken) return usage(taken.error());
    return result;
}

}  // namespace asip::gateway
