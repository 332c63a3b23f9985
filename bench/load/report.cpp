// SPDX-License-Identifier: Apache-2.0
#include "bench/load/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/text/duration.hpp"

namespace asip::load {
namespace {

using nlohmann::json;

json json_of(const Times& times) {
    return {{"count", times.count()},
            {"p50_ms", times.seconds(.5) * 1000},
            {"p99_ms", times.seconds(.99) * 1000},
            {"max_ms", times.longest_seconds() * 1000}};
}

std::string text_of(const Times& times) {
    if (times.count() == 0) return "-";
    const auto in_words = [](double seconds) {
        return text::duration_text(std::chrono::duration<double>(seconds));
    };
    return fmt::format("p50 {}, p99 {}, longest {}", in_words(times.seconds(.5)),
                       in_words(times.seconds(.99)), in_words(times.longest_seconds()));
}

std::string agreement(const Watched& watched) {
    if (!watched.agreed) return fmt::format("differs: {} boards", watched.wrong);
    return fmt::format("agrees, {} boards, {} after the end", watched.listed,
                       text::duration_text(*watched.agreed));
}

json json_of(const QueryTally& queries) {
    json kinds;
    for (std::size_t i = 0; i < kQuestionKinds; ++i) {
        const auto& kind = queries.kinds[i];
        kinds[std::string(name_of(QuestionKind{static_cast<std::uint8_t>(i)}))] = {
            {"asked", kind.asked},     {"answered", kind.answered}, {"unanswered", kind.unanswered},
            {"refused", kind.refused}, {"wrong", kind.wrong},       {"took", json_of(kind.took)}};
    }
    return {{"kinds", std::move(kinds)}, {"left_out", queries.left_out}};
}

json json_of(const WatchersTally& watchers) {
    json document = {{"watchers", watchers.watchers},
                     {"listening", watchers.listening},
                     {"connections_lost", watchers.connections_lost},
                     {"attempts_failed", watchers.attempts_failed}};
    for (const auto& [id, seen] : watchers.registries)
        document["registries"][id] = {
            {"events", seen.events},        {"different", seen.different}, {"very_late", seen.very_late},
            {"resets", seen.resets},        {"gaps", seen.gaps},           {"left_out", seen.left_out},
            {"first", json_of(seen.first)}, {"last", json_of(seen.last)}};
    return document;
}

class Table {
  public:
    template <class... Values>
    void row(std::string_view what, fmt::format_string<Values...> form, Values&&... values) {
        text_ += fmt::format("{:<22}{}\n", what, fmt::format(form, std::forward<Values>(values)...));
    }
    std::string take() { return std::move(text_); }

  private:
    std::string text_;
};

void add_rows(Table& table, const QueryTally& queries) {
    for (std::size_t i = 0; i < kQuestionKinds; ++i) {
        const auto& kind = queries.kinds[i];
        if (kind.asked == 0) continue;
        table.row(fmt::format("asked: {}", name_of(QuestionKind{static_cast<std::uint8_t>(i)})),
                  "{}: {} answered, {} unanswered, {} refused, {} wrong", kind.asked, kind.answered,
                  kind.unanswered, kind.refused, kind.wrong);
        table.row("  answered after", "{}", text_of(kind.took));
    }
    if (queries.answered() == 0) table.row("asked", "no question was answered");
    if (queries.left_out > 0) table.row("not asked", "{}: too many waited", queries.left_out);
}

void add_rows(Table& table, const WatchersTally& watchers) {
    table.row("watchers", "{} of {} listen at the end, {} connections lost, {} attempts failed",
              watchers.listening, watchers.watchers, watchers.connections_lost, watchers.attempts_failed);
    for (const auto& [id, seen] : watchers.registries) {
        table.row("  events of " + id, "{} in sum, {} different, {} numbers left out, {} resets", seen.events,
                  seen.different, seen.left_out, seen.resets);
        if (seen.very_late > 0) table.row("  very late", "{}", seen.very_late);
        table.row("  seen by the first", "{}", text_of(seen.first));
        table.row("  seen by the last", "{}", text_of(seen.last));
    }
}

}  // namespace

bool Report::good() const {
    return tally.descriptions > 0 && announced == present && tally.conflicts == 0 &&
           (!watched || !registries.empty()) &&
           (!queries || (queries->answered() > 0 && queries->wrong() == 0)) &&
           std::all_of(registries.begin(), registries.end(),
                       [](const auto& one) { return one.second.agreed.has_value(); });
}

json to_json(const Report& report) {
    const Tally& tally = report.tally;
    json document = {
        {"boards", report.boards},
        {"connections", report.connections},
        {"seconds", report.seconds},
        {"present", report.present},
        {"announced", report.announced},
        {"joined", tally.joined},
        {"died", tally.died},
        {"flapped", tally.flapped},
        {"hung", tally.hung},
        {"left", tally.left},
        {"conflicts", tally.conflicts},
        {"announcing", json_of(tally.announced)},
        {"descriptions", tally.descriptions},
        {"descriptions_per_second", static_cast<double>(tally.descriptions) / std::max(report.seconds, 1e-3)},
        {"values", tally.values},
        {"commands_answered", tally.commands},
        {"connections_made", tally.connections_made},
        {"connections_lost", tally.connections_lost},
        {"attempts_failed", tally.attempts_failed},
        {"published", tally.published},
        {"received", tally.received},
        {"dropped", tally.dropped},
        {"refused", tally.refused},
        {"denied", tally.denied},
        {"late", json_of(tally.late)},
        {"processor_seconds", report.usage.processor_seconds},
        {"resident_bytes", report.usage.resident_bytes},
        {"good", report.good()},
    };
    if (const auto& commands = report.commands)
        document["commands"] = {{"sent", commands->sent},         {"ok", commands->ok},
                                {"refused", commands->refused},   {"unanswered", commands->unanswered},
                                {"left_out", commands->left_out}, {"answered", json_of(commands->answered)}};
    if (report.queries) document["queries"] = json_of(*report.queries);
    if (report.watchers) document["watchers"] = json_of(*report.watchers);
    for (const auto& [id, watched] : report.registries) {
        document["registries"][id] = {
            {"events", watched.events},          {"resets", watched.numbers.resets},
            {"gaps", watched.numbers.gaps},      {"left_out", watched.numbers.left_out},
            {"online", json_of(watched.online)}, {"lost", json_of(watched.lost)},
            {"listed", watched.listed},          {"wrong", watched.wrong},
            {"examples", watched.examples}};
        if (watched.agreed)
            document["registries"][id]["agreed_after_ms"] =
                std::chrono::duration<double, std::milli>(*watched.agreed).count();
    }
    return document;
}

std::string to_table(const Report& report) {
    const Tally& tally = report.tally;
    Table table;
    table.row("boards", "{} over {} connections, for {:.1f} s", report.boards, report.connections,
              report.seconds);
    table.row("at the end", "{} present, {} announced", report.present, report.announced);
    table.row("happened", "{} joined, {} died, {} flapped, {} hung, {} left", tally.joined, tally.died,
              tally.flapped, tally.hung, tally.left);
    table.row("join until announced", "{}", text_of(tally.announced));
    table.row("descriptions", "{} published, {:.0f} a second", tally.descriptions,
              static_cast<double>(tally.descriptions) / std::max(report.seconds, 1e-3));
    if (tally.values > 0) table.row("values", "{}, of which {} dropped", tally.values, tally.dropped);
    table.row("commands answered", "{}", tally.commands);
    if (const auto& commands = report.commands) {
        table.row("commands sent", "{}: {} ok, {} refused, {} unanswered, {} left out", commands->sent,
                  commands->ok, commands->refused, commands->unanswered, commands->left_out);
        table.row("command to answer", "{}", text_of(commands->answered));
    }
    if (report.queries) add_rows(table, *report.queries);
    if (report.watchers) add_rows(table, *report.watchers);
    for (const auto& [id, watched] : report.registries) {
        table.row("registry " + id, "{}", agreement(watched));
        for (const auto& example : watched.examples)
            table.row("", "{}", example);
        table.row("  events", "{}, {} numbers left out, {} resets", watched.events, watched.numbers.left_out,
                  watched.numbers.resets);
        table.row("  announced to seen", "{}", text_of(watched.online));
        table.row("  died to seen", "{}", text_of(watched.lost));
    }
    if (report.watched && report.registries.empty()) table.row("registries", "none was there");
    if (tally.conflicts > 0)
        table.row("names of others", "{} boards: take another --prefix", tally.conflicts);
    table.row("connections", "{} made, {} lost, {} attempts failed", tally.connections_made,
              tally.connections_lost, tally.attempts_failed);
    table.row("messages", "{} out, {} in, {} refused here, {} denied by the broker", tally.published,
              tally.received, tally.refused, tally.denied);
    table.row("own timers late", "{}", text_of(tally.late));
    table.row("this program", "{:.1f} s of processor, {:.0f} MB, {:.1f} kB a board",
              report.usage.processor_seconds, report.usage.resident_bytes / 1e6,
              report.usage.resident_bytes / 1e3 / static_cast<double>(report.boards));
    return table.take();
}

}  // namespace asip::load
