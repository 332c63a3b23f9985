// SPDX-License-Identifier: Apache-2.0
#include "cli/events/stats_model.hpp"

#include "asip/model/json.hpp"
#include "asip/text/duration.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

using nlohmann::json;

// Agents publish every 15 s, unless told otherwise.
constexpr Duration kOld = std::chrono::seconds(45);

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

void StatsModel::take(const std::string& board, const std::string& payload, Time now) {
    auto document = model::parse_json(payload);
    if (document && document->is_object()) boards_[board] = {std::move(*document), now};
}

std::vector<json> StatsModel::records(Time now) const {
    std::vector<json> result;
    for (const auto& [name, board] : boards_) {
        auto record = board.document;
        record["board"] = name;
        record["age"] = std::chrono::duration<double>(now - board.seen).count();
        result.push_back(std::move(record));
    }
    return result;
}

Table StatsModel::table(Time now) const {
    Table table({{"BOARD"},
                 {"AGE", true},
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
    for (const auto& [name, board] : boards_) {
        const auto& document = board.document;
        const auto age = now - board.seen;
        const auto [all, failed] = commands(document);
        const double dropped =
            number(document, "/bus/dropped_values") + number(document, "/bus/dropped_answers");
        table.add({name, Cell(text::duration_text(age), age > kOld ? Colour::kRed : Colour::kNone),
                   time(document, "/uptime"), count_text(number(document, "/line/lines_in")),
                   count_text(number(document, "/line/lines_out")), count_text(all), bad(failed),
                   time(document, "/round_trip/p50"), time(document, "/round_trip/p99"),
                   count_text(number(document, "/queue/commands")),
                   count_text(number(document, "/holds/active")), bad(number(document, "/line/malformed")),
                   bad(number(document, "/line/resets")), bad(dropped)});
    }
    return table;
}

}  // namespace asip::cli
