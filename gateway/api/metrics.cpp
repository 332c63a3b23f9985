// SPDX-License-Identifier: Apache-2.0
#include "gateway/metrics/all_metrics.hpp"

#include <algorithm>

#include "asip/bus/pattern.hpp"
#include "gateway/api/limits.hpp"
#include "gateway/api/routes.hpp"

namespace asip::gateway::api {
namespace {

constexpr std::size_t kMaxPatterns = 20;

/// Which services' values are asked for.
using Patterns = std::vector<std::pair<std::string, std::string>>;

Expected<Patterns> patterns_of(const Call& call) {
    Patterns patterns;
    const auto* text = call.request.parameter("values");
    for (std::size_t at = 0; text != nullptr && at <= text->size();) {
        if (patterns.size() == kMaxPatterns)
            return fail("values: at most " + std::to_string(kMaxPatterns) + " patterns");
        const auto comma = std::min(text->find(',', at), text->size());
        const auto pattern = text->substr(at, comma - at);
        const auto slash = pattern.find('/');
        if (slash == std::string::npos || slash == 0 || slash + 1 == pattern.size())
            return fail(
                "values: must be BOARD/SERVICE, with * and ? as in a shell, and commas between several");
        patterns.emplace_back(pattern.substr(0, slash), pattern.substr(slash + 1));
        at = comma + 1;
    }
    return patterns;
}

/// An answer on its way: the values of one board are read in each step, then it is written.
struct Scrape {
    Gateway& gateway;
    http::Reply reply;
    Rights rights;
    Patterns patterns;
    metrics::Exposition::Format format;
    metrics::Snapshot snapshot;
    std::vector<std::string> boards;  ///< whose values are to be read
    std::optional<metrics::Writer> writer{};

    bool step() {
        if (!boards.empty() && !snapshot.values_left_out) {
            const auto board = std::move(boards.back());
            boards.pop_back();
            add_values(board);
            return true;
        }
        if (!writer) writer.emplace(std::move(snapshot), format);
        if (writer->step()) return true;
        http::Response response;
        response.content_type = metrics::Exposition::content_type(format);
        response.body = writer->text();
        response.headers = {{"Cache-Control", "no-store"}};
        reply.send(std::move(response));
        return false;
    }

    bool wanted(const std::string& board, const std::string& service) const {
        return rights.sees_service(board, service) &&
               std::any_of(patterns.begin(), patterns.end(), [&](const auto& each) {
                   return bus::matches_pattern(each.first, board) &&
                          bus::matches_pattern(each.second, service);
               });
    }

    /// The values of properties that are numbers, or true or false.
    void add_values(const std::string& board) {
        const auto now = gateway.now();
        const auto found = gateway.things().find(gateway.mirror(), board, now);
        if (!found) return;
        for (const auto& each : found->board->properties) {
            if (each.kind == property::Kind::kButton || !wanted(board, each.service)) continue;
            const auto shown = gateway.mirror().shown(board, each, now);
            if (!shown || !(shown->value.is_number() || shown->value.is_boolean())) continue;
            if (snapshot.values.size() == metrics::kMaxValues) {
                snapshot.values_left_out = true;
                return;
            }
            snapshot.values.push_back({board, each.id,
                                       shown->value.is_boolean() ? (shown->value.get<bool>() ? 1.0 : 0.0)
                                                                 : shown->value.get<double>()});
        }
    }
};

/// The boards of which some service may be asked for; the first one last.
std::vector<std::string> boards_for(Call& call, const Patterns& patterns, const metrics::Part& part) {
    std::vector<std::string> boards;
    if (!patterns.empty()) boards = call.gateway.mirror().board_names();
    std::erase_if(boards, [&](const std::string& board) {
        return !part.takes(board) || !call.sees(board) ||
               std::none_of(patterns.begin(), patterns.end(),
                            [&](const auto& each) { return bus::matches_pattern(each.first, board); });
    });
    std::sort(boards.rbegin(), boards.rend());
    return boards;
}

}  // namespace

void get_metrics(Call& call) {
    auto& gateway = call.gateway;
    if (!gateway.options().metrics) return send_problem(call, 404, "metrics are turned off");
    const auto& mirror = gateway.mirror();
    const auto& rights = call.principal.rights;
    if (rights.role == Role::kKiosk)
        return send_problem(call, 403, "a kiosk sees its boards only, and not what the bus counts");
    metrics::Snapshot snapshot;
    if (const auto* text = call.request.parameter("part")) {
        const auto part = metrics::Part::parse(*text);
        if (!part) return send_problem(call, 400, part.error());
        snapshot.part = *part;
    }
    auto patterns = patterns_of(call);
    if (!patterns) return send_problem(call, 400, patterns.error());
    metrics::read_process(snapshot);
    snapshot.server = gateway.server_counters();
    snapshot.commands = gateway.commands().counters();
    snapshot.durations = gateway.command_durations();
    snapshot.broker_connected = mirror.connected();
    snapshot.streams = gateway.streams().size();
    snapshot.values_refused = gateway.refused_values();
    snapshot.documents = mirror.standing().counters();
    snapshot.values_received = mirror.values().received();
    snapshot.values_skipped = mirror.values().left_out();
    snapshot.values_bytes = mirror.values().bytes();
    snapshot.last_values_bytes = mirror.values().last_bytes();
    const auto view = view_of(rights);
    const auto boards = mirror.boards_by_state(view);
    auto [lost, without_asip] = gateway.mirror().lost(view, call.now());
    for (std::size_t i = 0; i < catalogue::kStates; ++i) {
        const auto state = static_cast<model::BoardState>(i);
        const auto apart = state == model::BoardState::kLost ? std::min(without_asip, boards[i]) : 0;
        snapshot.boards_by_state.emplace_back(model::to_text(state), boards[i] - apart);
    }
    snapshot.boards_by_state.emplace_back("no-asip", without_asip);
    using Reason = model::StateReason;
    for (const auto reason : {Reason::kUnplugged, Reason::kSilent, Reason::kAgentGone, Reason::kExpired})
        snapshot.lost_by_reason.emplace_back(model::to_text(reason), lost[reason]);
    snapshot.lost_by_reason.emplace_back("unknown", lost[Reason::kNone]);
    snapshot.boards_out_of_date = mirror.out_of_date(view);
    snapshot.services_by_kind = mirror.services_by_kind(view);
    if (!rights.limited())  // what registries count is of all boards
        for (const auto& [id, info] : mirror.registries())
            snapshot.registries.emplace_back(id, info.stats);
    for (const auto& [board, info] : mirror.board_stats())
        if (snapshot.part.takes(board) && rights.sees_board(board))
            snapshot.boards.emplace_back(board, info.text);
    const bool open =
        call.request.header("accept").find("application/openmetrics-text") != std::string_view::npos;
    const auto format = open ? metrics::Exposition::Format::kOpenMetrics : metrics::Exposition::Format::kText;
    auto wanted = boards_for(call, *patterns, snapshot.part);
    const auto answer = std::make_shared<Scrape>(Scrape{gateway, call.reply, rights, std::move(*patterns),
                                                        format, std::move(snapshot), std::move(wanted)});
    call.reply.in_turns([answer] { return answer->step(); });
}

}  // namespace asip::gateway::api
