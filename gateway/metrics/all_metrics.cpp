// SPDX-License-Identifier: Apache-2.0
#include "gateway/metrics/all_metrics.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "asip/model/json.hpp"
#include "asip/protocol/body.hpp"

namespace asip::gateway::metrics {
namespace {

using nlohmann::json;
using Type = Exposition::Type;

const json* at(const json& object, std::string_view path) {
    const json* found = &object;
    while (!path.empty()) {
        const auto dot = std::min(path.find('.'), path.size());
        if (!found->is_object()) return nullptr;
        const auto member = found->find(std::string(path.substr(0, dot)));
        if (member == found->end()) return nullptr;
        found = &*member;
        path.remove_prefix(std::min(dot + 1, path.size()));
    }
    return found;
}

using Named = Writer::Named;

std::optional<double> number_at(const json& stats, std::string_view path) {
    const auto* value = at(stats, path);
    return value != nullptr && value->is_number() ? std::optional(value->get<double>()) : std::nullopt;
}

/// One number of each, where it is there. `label`: "board" or "registry".
Family number(std::string_view label, std::string_view path, std::string_view name, Type type,
              std::string_view unit, std::string_view help) {
    return {name, type, unit, help, [label, path](Exposition& out, const Named& each) {
                if (const auto value = number_at(each.stats, path)) out.sample({{label, each.name}}, *value);
            }};
}

Family directions(std::string_view name, std::string_view unit, std::string_view in, std::string_view to,
                  std::string_view help) {
    return {name, Type::kCounter, unit, help, [in, to](Exposition& out, const Named& each) {
                for (const auto& [path, direction] : {std::pair(in, "in"), std::pair(to, "out")})
                    if (const auto value = number_at(each.stats, path))
                        out.sample({{"board", each.name}, {"direction", direction}}, *value);
            }};
}

// A map of counters: each member is a value of the label.
Family by_member(const char* member, std::string_view name, std::string_view label, std::string_view help) {
    return {name, Type::kCounter, {}, help, [member, label](Exposition& out, const Named& each) {
                const auto* map = at(each.stats, member);
                if (map == nullptr || !map->is_object()) return;
                std::size_t shown = 0;
                double rest = 0;
                for (const auto& [key, value] : map->items()) {
                    if (!value.is_number()) continue;
                    if (++shown <= kMaxOutcomes)
                        out.sample({{"board", each.name}, {label, key}}, value.get<double>());
                    else
                        rest += value.get<double>();
                }
                if (shown > kMaxOutcomes) out.sample({{"board", each.name}, {label, "other"}}, rest);
            }};
}

std::vector<double> list(const json* array) {
    std::vector<double> result;
    if (array == nullptr || !array->is_array()) return result;
    for (const auto& value : *array)
        result.push_back(value.is_number() ? value.get<double>() : 0);
    return result;
}

void round_trip(Exposition& out, const Named& each) {
    const auto bounds = list(at(each.stats, "round_trip.le"));
    const auto buckets = list(at(each.stats, "round_trip.buckets"));
    const auto count = number_at(each.stats, "round_trip.count");
    const auto sum = number_at(each.stats, "round_trip.sum");
    if (!bounds.empty() && bounds.size() == buckets.size() && count && sum)
        out.histogram({{"board", each.name}}, bounds, buckets, *count, *sum);
}

const std::vector<Family>& families_of_boards() {
    const auto board = [](std::string_view path, std::string_view name, Type type, std::string_view unit,
                          std::string_view help) { return number("board", path, name, type, unit, help); };
    static const std::vector<Family> all{
        directions("asip_board_line_bytes", "bytes", "line.bytes_in", "line.bytes_out",
                   "Bytes from the board and to it"),
        directions("asip_board_lines", {}, "line.lines_in", "line.lines_out",
                   "Lines from the board and to it"),
        board("uptime", "asip_board_agent_uptime_seconds", Type::kGauge, "seconds",
              "Since the agent opened the port first"),
        board("line.undecoded", "asip_board_undecoded_reports", Type::kCounter, {},
              "Reports that do not fit their service's model"),
        board("line.malformed", "asip_board_malformed_lines", Type::kCounter, {}, "Pieces that are no line"),
        board("line.checksum_errors", "asip_board_checksum_errors", Type::kCounter, {},
              "Lines with a wrong checksum"),
        board("line.fence_timeouts", "asip_board_fence_timeouts", Type::kCounter, {},
              "Questions behind commands that were not answered in time"),
        board("line.unexplained_errors", "asip_board_unexplained_errors", Type::kCounter, {},
              "Errors that belong to no command"),
        board("line.resets", "asip_board_resets", Type::kCounter, {}, "Restarts of the board"),
        board("line.opened", "asip_board_link_opens", Type::kCounter, {},
              "How often the way to the board was opened"),
        board("queue.commands", "asip_board_queued_commands", Type::kGauge, {}, "Commands that wait"),
        board("holds.active", "asip_board_holds", Type::kGauge, {}, "Held commands in force"),
        board("holds.expired", "asip_board_expired_holds", Type::kCounter, {},
              "Held commands that were undone"),
        board("stops", "asip_board_stops", Type::kCounter, {}, "How often the board was stopped"),
        board("bus.connects", "asip_board_broker_connects", Type::kCounter, {}, "Connections to a broker"),
        board("bus.failures", "asip_board_broker_failures", Type::kCounter, {},
              "Connections that failed or were lost"),
        board("bus.published", "asip_board_published_messages", Type::kCounter, {}, "Messages to the broker"),
        board("bus.received", "asip_board_received_messages", Type::kCounter, {}, "Messages from the broker"),
        board("bus.dropped_values", "asip_board_dropped_values", Type::kCounter, {},
              "Values that gave way because the broker was slower"),
        board("bus.rejected", "asip_board_rejected_messages", Type::kCounter, {},
              "Messages that the broker refused"),
        by_member("errors", "asip_board_errors", "code", "Errors that the board sent"),
        by_member("commands", "asip_board_commands", "outcome", "Commands by what became of them"),
        {"asip_board_command_duration_seconds", Type::kHistogram, "seconds",
         "From a command's arrival at the agent to its answer", round_trip}};
    return all;
}

void add_registries(Exposition& out, const std::vector<std::pair<std::string, std::string>>& all) {
    std::vector<Named> registries;
    for (const auto& [name, text] : all)
        if (auto stats = model::parse_json(text); stats && stats->is_object())
            registries.push_back({name, std::move(*stats)});
    for (const auto& family : {number("registry", "messages", "asip_registry_messages", Type::kCounter, {},
                                      "Messages that the registry received"),
                               number("registry", "events", "asip_registry_events", Type::kCounter, {},
                                      "Changes that it published"),
                               number("registry", "queries", "asip_registry_queries", Type::kCounter, {},
                                      "Queries that it answered"),
                               number("registry", "connections", "asip_registry_connections", Type::kCounter,
                                      {}, "Its connections to a broker"),
                               number("registry", "expired", "asip_registry_expired_leases", Type::kCounter,
                                      {}, "Leases that ran out"),
                               number("registry", "conflicts", "asip_registry_conflicts", Type::kGauge, {},
                                      "Boards that two agents claim")}) {
        out.family(family.name, family.type, family.unit, family.help);
        for (const auto& each : registries)
            family.sample(out, each);
    }
    out.family("asip_registry_boards", Type::kGauge, {}, "Boards that a registry knows, by state");
    for (const auto& each : registries) {
        const auto* states = at(each.stats, "boards");
        if (states == nullptr || !states->is_object()) continue;
        for (const auto& [state, count] : states->items())
            if (count.is_number())
                out.sample({{"registry", each.name}, {"state", state}}, count.get<double>());
    }
}

void one(Exposition& out, std::string_view name, Type type, std::string_view unit, std::string_view help,
         double value) {
    out.family(name, type, unit, help);
    out.sample({}, value);
}

void add_catalogue(Exposition& out, const Snapshot& snapshot) {
    out.family("asip_boards", Type::kGauge, {},
               "Boards by state; no-asip: a port where no sketch has answered yet");
    for (const auto& [state, count] : snapshot.boards_by_state)
        out.sample({{"state", state}}, static_cast<double>(count));
    out.family("asip_boards_lost", Type::kGauge, {}, "Boards that are lost, by reason");
    for (const auto& [reason, count] : snapshot.lost_by_reason)
        out.sample({{"reason", reason}}, static_cast<double>(count));
    one(out, "asip_boards_out_of_date", Type::kGauge, {},
        "Boards that are online, and whose agents have a newer version of their sketch",
        static_cast<double>(snapshot.boards_out_of_date));
    auto kinds = snapshot.services_by_kind;
    std::sort(kinds.begin(), kinds.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
    out.family("asip_services", Type::kGauge, {}, "Services by kind");
    double rest = 0;
    for (std::size_t i = 0; i < kinds.size(); ++i)
        if (i < kMaxKinds)
            out.sample({{"asip_service", kinds[i].first}}, static_cast<double>(kinds[i].second));
        else
            rest += static_cast<double>(kinds[i].second);
    if (kinds.size() > kMaxKinds) out.sample({{"asip_service", "other"}}, rest);
}

void add_gateway(Exposition& out, const Snapshot& s) {
    out.family("asip_gateway_build", Type::kInfo, {}, "The version that runs");
    out.sample({{"version", ASIP_VERSION}}, 1);
    const auto count = [](auto value) { return static_cast<double>(value); };
    one(out, "asip_gateway_broker_connected", Type::kGauge, {}, "Whether the bus is heard",
        s.broker_connected);
    one(out, "asip_gateway_http_requests", Type::kCounter, {}, "Requests", count(s.server.requests));
    one(out, "asip_gateway_http_broken_requests", Type::kCounter, {}, "Requests that were not HTTP",
        count(s.server.broken));
    one(out, "asip_gateway_http_sent_bytes", Type::kCounter, "bytes", "Bytes of answers",
        count(s.server.sent_bytes));
    one(out, "asip_gateway_http_connections", Type::kGauge, {}, "Open connections", count(s.server.open));
    one(out, "asip_gateway_http_accepted_connections", Type::kCounter, {}, "Accepted connections",
        count(s.server.accepted));
    one(out, "asip_gateway_http_refused_connections", Type::kCounter, {}, "Connections beyond a limit",
        count(s.server.turned_away));
    one(out, "asip_gateway_http_timed_out_connections", Type::kCounter, {},
        "Connections that were too slow or idle", count(s.server.timed_out));
    one(out, "asip_gateway_streams", Type::kGauge, {}, "Open streams", count(s.streams));
    one(out, "asip_gateway_websockets", Type::kGauge, {}, "Open WebSockets", count(s.server.websockets));
    one(out, "asip_gateway_values", Type::kCounter, {}, "Values received", count(s.values_received));
    one(out, "asip_gateway_left_out_values", Type::kCounter, {}, "Values that slow readers did not get",
        count(s.values_skipped));
    one(out, "asip_gateway_refused_values", Type::kCounter, {},
        "Reported values that a property cannot have, left out of exports", count(s.values_refused));
    out.family("asip_gateway_dropped_documents", Type::kCounter, {},
               "Lists of properties and values that were dropped");
    out.sample({{"reason", "damaged"}}, count(s.documents.damaged));
    out.sample({{"reason", "outdated"}}, count(s.documents.outdated));
    one(out, "asip_gateway_kept_values_bytes", Type::kGauge, "bytes", "Recent values in memory",
        count(s.values_bytes));
    one(out, "asip_gateway_last_values_bytes", Type::kGauge, "bytes", "Last value of each event in memory",
        count(s.last_values_bytes));
    out.family("asip_gateway_commands", Type::kCounter, {}, "Commands by what became of them");
    out.sample({{"outcome", "ok"}}, count(s.commands.ok));
    out.sample({{"outcome", "error"}}, count(s.commands.error));
    out.sample({{"outcome", "timeout"}}, count(s.commands.timeout));
    out.sample({{"outcome", "refused"}}, count(s.commands.refused));
    out.family("asip_gateway_command_duration_seconds", Type::kHistogram, "seconds",
               "From a command's request to its answer");
    out.histogram({}, CommandTimes::bounds(), s.durations.buckets(), s.durations.count(), s.durations.sum());
}

void add_process(Exposition& out, const Snapshot& s) {
    one(out, "process_cpu_seconds", Type::kCounter, "seconds", "Processor time used", s.processor_seconds);
    one(out, "process_resident_memory_bytes", Type::kGauge, "bytes", "Memory in use", s.resident_bytes);
    one(out, "process_open_fds", Type::kGauge, {}, "Open file descriptors", s.open_files);
    one(out, "process_start_time_seconds", Type::kGauge, "seconds", "Start, in seconds since 1970",
        s.started_at);
}

}  // namespace

bool Part::takes(std::string_view board) const {
    // FNV-1a: the same in each gateway, and after each start.
    std::uint64_t hash = 0xcbf29ce484222325;
    for (const char byte : board)
        hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3;
    // Names that differ in their last digits differ in few bits until these are mixed (as MurmurHash3 ends).
    hash = (hash ^ (hash >> 33)) * 0xff51afd7ed558ccd;
    hash = (hash ^ (hash >> 33)) * 0xc4ceb9fe1a85ec53;
    return (hash ^ (hash >> 33)) % of == number - 1;
}

Expected<Part> Part::parse(std::string_view text) {
    const auto slash = std::min(text.find('/'), text.size());
    const auto number = protocol::parse_integer(text.substr(0, slash));
    const auto of = protocol::parse_integer(text.substr(std::min(slash + 1, text.size())));
    if (!number || !of || *of < 1 || *of > static_cast<std::int64_t>(kMaxParts) || *number < 1 ||
        *number > *of)
        return fail("part: must be NUMBER/OF, such as 2/4; at most " + std::to_string(kMaxParts) + " parts");
    return Part{static_cast<std::size_t>(*number), static_cast<std::size_t>(*of)};
}

Writer::Writer(Snapshot snapshot, Exposition::Format format) : snapshot_(std::move(snapshot)), out_(format) {}

bool Writer::step() {
    if (!begun_) {
        begun_ = true;
        if (snapshot_.part.is_first()) {
            add_gateway(out_, snapshot_);
            add_catalogue(out_, snapshot_);
            add_registries(out_, snapshot_.registries);
            add_process(out_, snapshot_);
        }
        return true;
    }
    const auto known = std::min(snapshot_.boards.size(), kMaxBoards);
    if (read_ < known) {
        for (const auto end = std::min(read_ + kRead, known); read_ < end; ++read_)
            if (auto stats = model::parse_json(snapshot_.boards[read_].second); stats && stats->is_object())
                boards_.push_back({std::move(snapshot_.boards[read_].first), std::move(*stats)});
        return true;
    }
    if (family_ < families_of_boards().size()) {
        add_family(families_of_boards()[family_]);
        return true;
    }
    return add_values();
}

void Writer::add_family(const Family& family) {
    if (at_ == 0) out_.family(family.name, family.type, family.unit, family.help);
    for (const auto end = std::min(at_ + kWritten, boards_.size()); at_ < end; ++at_)
        family.sample(out_, boards_[at_]);
    if (at_ < boards_.size()) return;
    at_ = 0;
    ++family_;
}

bool Writer::add_values() {
    const auto& values = snapshot_.values;
    if (at_ == 0) {
        const auto boards = snapshot_.boards.size();
        one(out_, "asip_gateway_unshown_boards", Type::kGauge, {}, "Boards beyond the limit of label values",
            static_cast<double>(boards - std::min(boards, kMaxBoards)));
        if (!values.empty()) out_.family("asip_value", Type::kGauge, {}, "How properties of boards stand");
    }
    for (const auto end = std::min(at_ + kWritten, values.size()); at_ < end; ++at_)
        out_.sample({{"board", values[at_].board}, {"property", values[at_].property}}, values[at_].value);
    if (at_ < values.size()) return true;
    if (!values.empty())
        one(out_, "asip_gateway_unshown_values", Type::kGauge, {},
            "Whether there are more values than are shown", snapshot_.values_left_out);
    return false;
}

}  // namespace asip::gateway::metrics
