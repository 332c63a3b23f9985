// SPDX-License-Identifier: Apache-2.0
#include "gateway/metrics/metrics.hpp"

#include "gateway/api/limits.hpp"
#include "gateway/api/routes.hpp"

namespace asip::gateway::api {

void get_metrics(Call& call) {
    auto& gateway = call.gateway;
    if (!gateway.options().metrics) return send_problem(call, 404, "metrics are turned off");
    const auto& mirror = gateway.mirror();
    const auto& rights = call.principal.rights;
    if (rights.role == Role::kKiosk)
        return send_problem(call, 403, "a kiosk sees its boards only, and not what the bus counts");
    metrics::Snapshot snapshot;
    metrics::read_process(snapshot);
    snapshot.server = gateway.server_counters();
    snapshot.commands = gateway.commands().counters();
    snapshot.durations = gateway.command_durations();
    snapshot.broker_connected = mirror.connected();
    snapshot.streams = gateway.streams().size();
    snapshot.values_received = mirror.values().received();
    snapshot.values_left_out = mirror.values().left_out();
    snapshot.values_bytes = mirror.values().bytes();
    snapshot.last_values_bytes = mirror.values().last_bytes();
    const auto view = view_of(rights);
    const auto boards = mirror.boards_by_state(view);
    for (std::size_t i = 0; i < catalogue::kStates; ++i) {
        snapshot.boards_by_state.emplace_back(model::to_text(static_cast<model::BoardState>(i)), boards[i]);
    }
    using Reason = model::StateReason;
    auto lost = mirror.lost_by_reason(view);
    for (const auto reason : {Reason::kUnplugged, Reason::kSilent, Reason::kAgentGone, Reason::kExpired})
        snapshot.lost_by_reason.emplace_back(model::to_text(reason), lost[reason]);
    snapshot.lost_by_reason.emplace_back("unknown", lost[Reason::kNone]);
    snapshot.services_by_kind = mirror.services_by_kind(view);
    if (!rights.limited()) {  // what registries count is of all boards
        for (const auto& [id, info] : mirror.registries())
            snapshot.registries.emplace_back(id, info.stats);
    }
    for (const auto& [board, info] : mirror.board_stats()) {
        if (rights.sees_board(board)) snapshot.boards.emplace_back(board, info.text);
    }
    const bool open =
        call.request.header("accept").find("application/openmetrics-text") != std::string_view::npos;
    const auto format = open ? metrics::Exposition::Format::kOpenMetrics : metrics::Exposition::Format::kText;
    http::Response response;
    response.content_type = metrics::Exposition::content_type(format);
    response.body = metrics::exposition(snapshot, format);
    response.headers = {{"Cache-Control", "no-store"}};
    call.reply.send(std::move(response));
}

}  // namespace asip::gateway::api
