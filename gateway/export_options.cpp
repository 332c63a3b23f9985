// SPDX-License-Identifier: Apache-2.0
#include "gateway/export_options.hpp"

#include <algorithm>

#include "asip/bus/topics.hpp"
#include "asip/program/app.hpp"
#include "asip/program/options.hpp"
#include "asip/text/printable.hpp"
#include "asip/text/wall_time.hpp"
#include "gateway/export/exporter.hpp"
#include "gateway/export/sparkplug_node.hpp"

namespace asip::gateway {
namespace {

/// What all kinds of exports are made with.
template <class Options>
Options export_of(const ExportOptions& raw, const ProgramOptions& options, bool enabled) {
    Options result;
    result.gateway = options.mqtt.client_id;
    result.host = program::host_name();
    result.per_second = raw.per_second;
    result.enabled = enabled && !raw.clean;
    result.clear_all = raw.clean.has_value();
    return result;
}

bool is_meant(const ExportOptions& raw, std::string_view name) {
    return !raw.clean || raw.clean->empty() || *raw.clean == name;
}

void add_export(const ExportOptions& raw, bool enabled, std::shared_ptr<const exports::Dialect> dialect,
                ProgramOptions& options) {
    if (!is_meant(raw, dialect->by())) return;
    if (enabled) options.exports_on.emplace(dialect->by());
    auto made = export_of<exports::Exporter::Options>(raw, options, enabled);
    made.dialect = std::move(dialect);
    options.exports.emplace_back([made](Random random, exports::Export::Port port) {
        return std::make_unique<exports::Exporter>(made, std::move(random), std::move(port));
    });
}

/// Where others find the page, as far as the options tell; empty: nowhere, or behind a proxy.
std::string page_of(const ProgramOptions& options) {
    if (!options.gateway.page || !options.gateway.base_path.empty()) return {};
    const auto& host = options.gateway.gate.hosts.front();
    for (const auto& address : options.addresses) {
        const auto colon = address.rfind(':');
        if (address.starts_with("unix:") || colon == std::string::npos) continue;
        const auto at = address.substr(0, colon), port = address.substr(colon);
        const bool own = at.starts_with("127.") || at == "localhost" || at == "[::1]";
        const bool any = at.empty() || at == "0.0.0.0" || at == "[::]";
        if (own || port == ":0" || (any && host == "localhost")) continue;
        return (options.http_cert.empty() ? "http://" : "https://") + (host == "localhost" ? at : host) +
               port + "/";
    }
    return {};
}

Expected<void> home_assistant_of(ExportOptions& raw, bool enabled, ProgramOptions& options) {
    auto& home = raw.home;
    home.root = options.gateway.topic_root;
    home.version = ASIP_VERSION;
    home.page = page_of(options);
    home.started = text::iso_time(text::wall_now());
    if (!raw.home_assistant.empty()) home.prefix = raw.home_assistant;
    if (!bus::Topics::valid_root(home.prefix))
        return fail("--home-assistant: \"" + text::printable(home.prefix) + "\" is no beginning of a topic");
    if (home.prefix == options.gateway.topic_root)
        return fail("--home-assistant: must differ from --topic-root");
    if (!enabled && (home.read_only || home.entity_ids))
        return fail("home-assistant-read-only and home-assistant-entity-ids need --home-assistant");
    add_export(raw, enabled, std::make_shared<exports::HomeAssistant>(home), options);
    return {};
}

Expected<void> homie_of(ExportOptions& raw, bool enabled, ProgramOptions& options) {
    auto& homie = raw.homie;
    homie.root = options.gateway.topic_root;
    if (!raw.homie_domain.empty()) homie.domain = raw.homie_domain;
    if (!exports::Homie::valid_domain(homie.domain))
        return fail("--homie: \"" + text::printable(homie.domain) + "\": allowed are a-z, 0-9 and -");
    if (homie.domain == options.gateway.topic_root) return fail("--homie: must differ from --topic-root");
    if (!enabled && homie.read_only) return fail("homie-read-only needs --homie");
    add_export(raw, enabled, std::make_shared<exports::Homie>(homie), options);
    return {};
}

Expected<void> sparkplug_of(ExportOptions& raw, bool enabled, ProgramOptions& options) {
    auto& node = raw.sparkplug;
    node.root = options.gateway.topic_root;
    node.version = ASIP_VERSION;
    const auto slash = raw.sparkplug_group.find('/');
    node.group = raw.sparkplug_group.substr(0, slash);
    node.edge = slash == std::string::npos ? node.root : raw.sparkplug_group.substr(slash + 1);
    if (slash == std::string::npos) std::replace(node.edge.begin(), node.edge.end(), '/', '-');
    if (enabled && (!exports::Sparkplug::valid_id(node.group) || !exports::Sparkplug::valid_id(node.edge)))
        return fail("--sparkplug: \"" + text::printable(raw.sparkplug_group) +
                    "\" must be GROUP or GROUP/EDGE, without spaces, + and #");
    if (!node.host.empty() && !exports::Sparkplug::valid_id(node.host))
        return fail("sparkplug-host: \"" + text::printable(node.host) + "\" is no name of a host");
    if (!enabled && (node.read_only || !node.host.empty()))
        return fail("sparkplug-read-only and sparkplug-host need --sparkplug");
    auto made = export_of<exports::SparkplugNode::Options>(raw, options, enabled);
    if (!is_meant(raw, "sparkplug")) return {};
    if (enabled) options.exports_on.emplace("sparkplug");
    made.dialect = node;
    options.exports.emplace_back([made](Random random, exports::Export::Port port) {
        return std::make_unique<exports::SparkplugNode>(made, std::move(random), std::move(port));
    });
    return {};
}

}  // namespace

void declare_exports(program::App& app, program::Settings& settings, ExportOptions& raw) {
    const auto add = [&](const program::Option& option) { settings.setting(option).group("Exports"); };
    add(app.add_option("--home-assistant", raw.home_assistant,
                       "Show every board to Home Assistant on the same broker; PREFIX: where it looks for "
                       "devices, otherwise homeassistant")
            .type("[PREFIX]")
            .value_optional());
    add(app.add_flag("--home-assistant-read-only", raw.home.read_only, "Home Assistant may set nothing"));
    add(app.add_flag(
        "--home-assistant-entity-ids", raw.home.entity_ids,
        "Propose the ids of its entities, sensor.BOARD_SERVICE_0; otherwise they follow from names"));
    add(app.add_option(
               "--homie", raw.homie_domain,
               "Show every board as a Homie 5 device; DOMAIN: the first level of its topics, otherwise homie")
            .type("[DOMAIN]")
            .value_optional());
    add(app.add_flag("--homie-read-only", raw.homie.read_only, "Homie controllers may set nothing"));
    add(app.add_option("--sparkplug", raw.sparkplug_group,
                       "Show every board as a device of Sparkplug B, in this group; EDGE: the name of this "
                       "bus as an edge node, otherwise the topic root")
            .type("GROUP[/EDGE]"));
    add(app.add_option("--sparkplug-host", raw.sparkplug.host,
                       "Show them only while this primary host says that it is online")
            .type("ID"));
    add(app.add_flag("--sparkplug-read-only", raw.sparkplug.read_only, "Sparkplug hosts may set nothing"));
    add(app.add_flag("--no-wot", raw.no_wot, "No things of the Web of Things over HTTP"));
    add(app.add_option("--export-hz", raw.per_second, "Most states of one entity a second")
            .range(0.1, 100.0)
            .show_default());
}

Expected<void> make_exports(ExportOptions& raw, const program::App& app, ProgramOptions& options) {
    // From the environment or a file comes a value, on the command line the option may stand alone.
    const auto given = [&](const char* option, const std::string& value) {
        return !value.empty() || app.given(option);
    };
    if (auto home = home_assistant_of(raw, given("--home-assistant", raw.home_assistant), options); !home)
        return home;
    options.gateway.things = {.enabled = !raw.no_wot, .topic_root = options.gateway.topic_root};
    if (auto homie = homie_of(raw, given("--homie", raw.homie_domain), options); !homie) return homie;
    return sparkplug_of(raw, given("--sparkplug", raw.sparkplug_group), options);
}

}  // namespace asip::gateway
