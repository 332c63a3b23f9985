// SPDX-License-Identifier: Apache-2.0
#include "registry/options.hpp"

#include <cstdlib>
#include <iostream>
#include <limits>

#include "asip/bus/topics.hpp"
#include "asip/model/names.hpp"
#include "asip/program/app.hpp"
#include "asip/program/exit_status.hpp"
#include "asip/program/options.hpp"
#include "asip/text/duration.hpp"
#include "registry/webhook_address.hpp"

namespace asip::registry {
namespace {

constexpr const char* kAbout =
    "Keeps the live catalogue of boards and services: listens to the service bus, judges leases, answers\n"
    "queries and reports changes. Needs no configuration next to the broker. Any number may run side by "
    "side.";

constexpr const char* kExamples =
    "Examples:\n"
    "  asip-registry\n"
    "      For the broker on this machine.\n"
    "  asip-registry --broker broker.local,backup.local --id hall-2\n"
    "      Two brokers: the second is used while the first does not answer.\n"
    "  asip-registry --history /var/lib/asip/history.db\n"
    "      Keeps what changed when.\n"
    "  asip-registry --notify https://hooks.example/lab\n"
    "      Tells it when boards are lost and back.\n"
    "  asipctl list\n"
    "      Asks it.\n"
    "\n"
    "Exit status: 0 stopped by a signal; 1 failed while running; 2 bad option; 3 the broker refused the "
    "connection;\n6 another registry uses the id.";

constexpr std::uint64_t kMinHistoryBytes = 64u << 10;
constexpr std::uint64_t kMaxHistoryBytes = std::numeric_limits<std::int64_t>::max();

struct Raw {
    program::BrokerOptions broker;
    program::LogOptions log;
    std::string id, services, history, notify;
    std::string forget_after = "7d", stats_interval = "10s", history_age = "90d";
    std::size_t max_boards = 1'000'000;
    std::uint64_t history_bytes = std::uint64_t{256} << 20;
    std::string values = "named";
    std::uint64_t values_bytes = std::uint64_t{1} << 30;
    double values_demand = 0;
    std::string values_age = "48h,90d,1826d";
};

void declare(program::App& app, program::Settings& settings, Raw& raw) {
    const auto own = [&](const program::Option& each) { settings.setting(each).group("Registry"); };
    const auto history = [&](const program::Option& each) { settings.setting(each).group("History"); };
    own(app.add_option("--id", raw.id, "Name of this registry on the bus; default: this machine's name"));
    own(app.add_option("--forget-after", raw.forget_after,
                       "How long a board that left stays in the catalogue (90s, 15m, 12h, 7d)")
            .show_default());
    own(app.add_option("--max-boards", raw.max_boards, "Boards beyond this many are refused")
            .range(std::size_t{1}, std::size_t{100'000'000})
            .show_default());
    own(app.add_option("--services", raw.services, "Folder of further service models (*.json)"));
    own(app.add_option("--stats-interval", raw.stats_interval, "How often statistics are published")
            .show_default());
    own(app.add_option("--notify", raw.notify,
                       "Address (http:// or https://) that gets a message when boards are lost and back")
            .type("URL"));
    history(app.add_option("--history", raw.history,
                           "SQLite file to keep changes in, or none; default: history.db in "
                           "$STATE_DIRECTORY, which a service has, else none"));
    history(app.add_option("--history-age", raw.history_age, "Changes older than this are dropped")
                .show_default());
    history(app.add_option("--history-size", raw.history_bytes,
                           "Maximum size of the file (512k, 256M, 2G); the oldest changes are dropped")
                .bytes(kMinHistoryBytes, kMaxHistoryBytes)
                .show_default("256M"));
    history(app.add_option("--values", raw.values,
                           "Whose values are kept beside the history: named (and on dashboards), "
                           "these and BOARD/PROPERTY (* and ?), a comma between; or none")
                .show_default());
    history(app.add_option("--values-size", raw.values_bytes,
                           "Maximum size of the values; the oldest are dropped")
                .bytes(kMinHistoryBytes, kMaxHistoryBytes)
                .show_default("1G"));
    history(app.add_option("--values-age", raw.values_age,
                           "How long each change, each minute and each hour of values is kept")
                .show_default());
    history(app.add_option("--values-demand", raw.values_demand,
                           "Values a second that boards are to report for it; 0: as they do anyway")
                .range(0.0, 1.0)
                .show_default());
}

/// A service keeps a history without being told to.
std::string history_file(const std::string& given) {
    if (given == "none") return {};
    const char* folders = std::getenv("STATE_DIRECTORY");
    if (!given.empty() || folders == nullptr || *folders == '\0') return given;
    const std::string_view all(folders);
    return std::string(all.substr(0, all.find(':'))) + "/history.db";
}

/// "named,desk/*"
Expected<std::vector<std::string>> parse_value_patterns(const std::string& text) {
    std::vector<std::string> patterns;
    for (std::size_t at = 0; at <= text.size();) {
        const auto comma = std::min(text.find(',', at), text.size());
        const auto pattern = text.substr(at, comma - at);
        const auto slash = pattern.find('/');
        const bool whole = slash != std::string::npos && slash > 0 && slash + 1 < pattern.size() &&
                           pattern.find(' ') == std::string::npos;
        if (pattern != "named" && !whole)
            return fail("\"" + pattern + "\" is neither named nor BOARD/PROPERTY, such as desk/temperature");
        if (whole) patterns.push_back(pattern);
        at = comma + 1;
    }
    return patterns;
}

/// "48h,90d,1826d"
Expected<std::array<Duration, 3>> parse_value_ages(const std::string& text) {
    std::array<Duration, 3> ages{};
    std::size_t at = 0;
    for (auto& age : ages) {
        const auto comma = std::min(text.find(',', at), text.size());
        const auto parsed = at > text.size() ? fail("three times are needed, such as 48h,90d,1826d")
                                             : parse_period(text.substr(at, comma - at));
        if (!parsed) return Unexpected<std::string>(parsed.error());
        age = *parsed;
        at = comma + 1;
    }
    if (at <= text.size()) return fail("three times are needed, such as 48h,90d,1826d");
    if (ages[0] > ages[1] || ages[1] > ages[2])
        return fail("what is coarser is kept for longer, such as 48h,90d,1826d");
    return ages;
}

template <class Value, class Parse>
bool convert(const char* option, const std::string& text, const Parse& parse, Value& value) {
    const auto parsed = parse(text);
    if (!parsed) {
        std::cerr << "asip-registry: " << option << ": " << parsed.error() << "\n";
        return false;
    }
    value = *parsed;
    return true;
}

}  // namespace

Expected<Duration> parse_period(const std::string& text) {
    const auto period = text::parse_duration(text);
    if (!period) return Unexpected<std::string>(period.error());
    if (*period < std::chrono::seconds(1)) return fail("'" + text + "' is less than a second");
    return *period;
}

Expected<RegistryOptions, int> read_options(int argc, const char* const* argv) {
    program::App app{kAbout};
    app.footer(kExamples);
    program::Settings settings(app, "asip-registry");
    Raw raw;
    declare(app, settings, raw);
    settings.add_broker_options(raw.broker);
    settings.add_credentials_dir(raw.broker);
    settings.add_log_options(raw.log);
    settings.arrange(
        {"id", "services", "history", "notify", "broker", "credentials", "user", "password-file", "ca",
         "log-level"},
        {"forget-after", "max-boards", "stats-interval", "history-age", "history-size", "values",
         "values-size", "values-age", "values-demand", "mqtt-version", "credentials-dir", "log-format"});
    if (auto status = settings.parse(argc, argv)) return Unexpected<int>(*status);

    const Unexpected<int> usage(program::kExitUsage);
    RegistryOptions options;
    if (!convert("forget-after", raw.forget_after, parse_period, options.forget_after) ||
        !convert("stats-interval", raw.stats_interval, parse_period, options.stats_interval) ||
        !convert("history-age", raw.history_age, parse_period, options.history_age)) {
        return usage;
    }
    options.keeps_values = raw.values != "none";
    if (options.keeps_values && !convert("values", raw.values, parse_value_patterns, options.values))
        return usage;
    if (!convert("values-age", raw.values_age, parse_value_ages, options.values_age)) return usage;
    options.values_bytes = static_cast<std::size_t>(raw.values_bytes);
    options.values_demand = raw.values_demand;
    options.history_bytes = static_cast<std::size_t>(raw.history_bytes);
    auto mqtt = program::mqtt_options(raw.broker, "asip-registry");
    if (!mqtt) {
        std::cerr << "asip-registry: " << mqtt.error() << "\n";
        return usage;
    }
    options.mqtt = std::move(*mqtt);
    options.topic_root = raw.broker.topic_root;
    options.id = raw.id.empty() ? model::suggest_name(program::host_name()) : raw.id;
    if (!model::valid_name(options.id) || options.id == "query") {
        std::cerr << "asip-registry: --id: \"" << options.id
                  << "\" is not a name; use 1 to 64 of A-Z a-z 0-9 . _ - (and not \"query\")\n";
        return usage;
    }
    options.max_boards = raw.max_boards;
    options.services = raw.services;
    options.history = history_file(raw.history);
    options.notify = raw.notify;
    if (options.notify.empty()) return options;
    if (const auto webhook = parse_webhook(options.notify); !webhook) {
        std::cerr << "asip-registry: --notify: " << webhook.error() << "\n";
        return usage;
    }
    return options;
}

}  // namespace asip::registry
