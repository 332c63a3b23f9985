// SPDX-License-Identifier: Apache-2.0
#include "cli/doctor/agents.hpp"

#include <ostream>
#include <utility>

#include "asip/model/json.hpp"
#include "asip/text/duration.hpp"
#include "cli/ask/bus_session.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

using nlohmann::json;

// A little more than the time between two documents of an agent.
constexpr Duration kRound = std::chrono::seconds(16);

const json& at_path(const json& document, const char* path) {
    static const json kNone;
    const json::json_pointer pointer(path);
    return document.contains(pointer) ? document.at(pointer) : kNone;
}

double number(const json& document, const char* path) {
    const auto& value = at_path(document, path);
    return value.is_number() ? value.get<double>() : 0;
}

std::string time(const json& document, const char* path) {
    const auto& value = at_path(document, path);
    return value.is_number() ? text::duration_text(std::chrono::duration<double>(value.get<double>())) : "-";
}

/// Those that were to be executed, and those of them that were not, or of which no program knows.
std::pair<double, double> commands(const json& document) {
    double all = 0;
    double failed = 0;
    const auto& outcomes = at_path(document, "/commands");
    if (!outcomes.is_object()) return {0, 0};
    for (const auto& [outcome, value] : outcomes.items()) {
        if (!value.is_number()) continue;
        all += value.get<double>();
        if (outcome != "ok" && outcome != "unproven") failed += value.get<double>();
    }
    return {all, failed};
}

Cell bad(double number) {
    return Cell(count_text(number), number > 0 ? Colour::kRed : Colour::kNone);
}

}  // namespace

void take_counts(AgentCounts& counts, const std::string& board, const std::string& payload) {
    auto document = model::parse_json(payload);
    if (document && document->is_object()) counts[board] = std::move(*document);
}

Table counts_table(const AgentCounts& counts) {
    Table table({{"BOARD"},
                 {"UP", true},
                 {"IN", true},
                 {"OUT", true},
                 {"COMMANDS", true},
                 {"FAILED", true},
                 {"P50", true},
                 {"P99", true},
                 {"QUEUE", true},
                 {"HELD", true},
                 {"BAD", true},
                 {"RESETS", true},
                 {"DROPPED", true}});
    for (const auto& [name, document] : counts) {
        const auto [all, failed] = commands(document);
        const double dropped =
            number(document, "/bus/dropped_values") + number(document, "/bus/dropped_answers");
        table.add({name, time(document, "/uptime"), count_text(number(document, "/line/lines_in")),
                   count_text(number(document, "/line/lines_out")), count_text(all), bad(failed),
                   time(document, "/round_trip/p50"), time(document, "/round_trip/p99"),
                   count_text(number(document, "/queue/commands")),
                   count_text(number(document, "/holds/active")), bad(number(document, "/line/malformed")),
                   bad(number(document, "/line/resets")), bad(dropped)});
    }
    return table;
}

int list_agents(const OutputOptions& output, Environment& environment) {
    BusSession session(environment);
    session.tell_refused_subscriptions();
    AgentCounts counts;
    const auto documents =
        session.subscribe(environment.topics.stats("+"),
                          [&](const mqtt::Message& message) {
                              const auto topic = environment.topics.parse(message.topic);
                              if (topic && !message.retain)
                                  take_counts(counts, std::string(topic->board), message.payload);
                          },
                          {.retained = false});
    if (const auto connected = session.connect(); !connected) return environment.fail_with(connected.error());
    environment.note("agents publish what they counted every 15 s: this takes as long");
    session.run_for(kRound);
    RecordPrinter records(output, RecordPrinter::Count::kList, environment.out);
    if (!output.for_people()) {
        for (auto& [board, document] : counts) {
            document["board"] = board;
            records.print(document);
        }
        records.finish();
    } else if (!counts.empty()) {
        environment.out << counts_table(counts).render(environment.width, environment.colour) << std::flush;
    }
    if (!counts.empty() || session.stopped()) return program::kExitOk;
    return environment.fail_with(session.unanswered("no agent published what it counted; see asipctl list"));
}

}  // namespace asip::cli
