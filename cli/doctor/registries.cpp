// SPDX-License-Identifier: Apache-2.0
#include "cli/doctor/registries.hpp"

#include <map>
#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/model/json.hpp"
#include "asip/text/duration.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/commands/list.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

using Json = nlohmann::json;

/// What a registry publishes about itself. Anybody may have written it.
struct SeenRegistry {
    std::string state;
    Json stats = Json::object();

    double number(const char* name) const {
        const auto found = stats.find(name);
        return found != stats.end() && found->is_number() ? found->get<double>() : 0;
    }
    double sum(const char* name) const {
        double total = 0;
        const auto found = stats.find(name);
        if (found == stats.end() || !found->is_object()) return 0;
        for (const auto& [key, value] : found->items())
            total += value.is_number() ? value.get<double>() : 0;
        return total;
    }
};

using SeenRegistries = std::map<std::string, SeenRegistry>;

std::vector<Cell> registry_row(const std::string& id, const SeenRegistry& registry) {
    const auto uptime = text::duration_text(std::chrono::duration<double>(registry.number("uptime")));
    const auto boards = registry.stats.value("boards", Json::object());
    const auto online = boards.is_object() ? boards.value("online", Json()) : Json();
    return {id,
            Cell(registry.state, state_colour(registry.state)),
            registry.stats.empty() ? std::string() : uptime,
            count_text(registry.sum("boards")),
            online.is_number() ? count_text(online.get<double>()) : std::string(),
            count_text(registry.sum("services")),
            value_at(registry.stats, "messages_per_second"),
            count_text(registry.number("queries")),
            count_text(registry.number("events")),
            count_text(registry.sum("refused")),
            value_at(registry.stats, "version")};
}

void take(SeenRegistries& registries, const bus::Topics& topics, const mqtt::Message& message) {
    const auto topic = topics.parse(message.topic);
    if (!topic || message.payload.empty()) return;
    auto& registry = registries[std::string(topic->board)];
    if (topic->kind == bus::TopicKind::kRegistryState) registry.state = message.payload;
    if (topic->kind != bus::TopicKind::kRegistryStats) return;
    if (auto document = model::parse_json(message.payload); document && document->is_object())
        registry.stats = std::move(*document);
}

}  // namespace

int list_registries(const OutputOptions& output, Environment& environment) {
    BusSession session(environment);
    SeenRegistries registries;
    const auto keep = [&](const mqtt::Message& message) { take(registries, environment.topics, message); };
    const auto states = session.subscribe(environment.topics.registry_state("+"), keep);
    const auto stats = session.subscribe(environment.topics.registry_stats("+"), keep);
    if (const auto connected = session.connect(); !connected) return environment.fail_with(connected.error());
    session.wait_retained();
    Table table({{"REGISTRY"},
                 {"STATE"},
                 {"UP", true},
                 {"BOARDS", true},
                 {"ONLINE", true},
                 {"SERVICES", true},
                 {"MSG/S", true},
                 {"QUERIES", true},
                 {"EVENTS", true},
                 {"REFUSED", true},
                 {"VERSION"}});
    RecordPrinter records(output, RecordPrinter::Count::kList, environment.out);
    for (const auto& [id, registry] : registries) {
        if (output.form == Output::kName && output.for_people()) {
            environment.say(id);
        } else if (output.for_people()) {
            table.add(registry_row(id, registry));
        } else {
            auto record = registry.stats;
            record["registry"] = id;
            record["state"] = registry.state;
            records.print(record);
        }
    }
    if (!output.for_people()) records.finish();
    if (!table.empty()) environment.out << table.render(environment.width, environment.colour);
    environment.out << std::flush;
    if (!registries.empty()) return program::kExitOk;
    return environment.fail_with(
        session.unanswered("no registry has ever run on this bus; start asip-registry"));
}

}  // namespace asip::cli
