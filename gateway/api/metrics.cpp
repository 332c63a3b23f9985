// SPDX-License-Identifier: Apache-2.0
#include "gateway/metrics/all_metrics.hpp"

#include <algorithm>

#include "asip/bus/registry/query.hpp"
#include "gateway/api/limits.hpp"
#include "gateway/api/routes.hpp"

namespace asip::gateway::api {
namespace {

constexpr std::size_t kMaxPatterns = 20;

/// Of the properties of a service that are numbers, or true or false.
void add_values(Call& call, const std::string& board, const std::string& service,
                std::vector<metrics::ValueSample>& values) {
    auto& mirror = call.gateway.mirror();
    const auto found = call.gateway.things().find(mirror, board, call.now());
    if (!found) return;
    for (const auto& each : found->board->properties) {
        if (each.service != service || each.kind == property::Kind::kButton) continue;
        const auto shown = mirror.shown(board, each, call.now());
        if (!shown || !(shown->value.is_number() || shown->value.is_boolean())) continue;
        values.push_back({board, each.id,
                          shown->value.is_boolean() ? (shown->value.get<bool>() ? 1.0 : 0.0)
                                                    : shown->value.get<double>()});
    }
}

/// The last values of the services that a pattern BOARD/SERVICE means, as far as they are seen and there is
/// room.
Expected<void> add_pattern(Call& call, std::string_view pattern, metrics::Snapshot& snapshot) {
    const auto slash = pattern.find('/');
    if (slash == std::string_view::npos || slash == 0 || slash + 1 == pattern.size())
        return fail("values: must be BOARD/SERVICE, with * and ? as in a shell, and commas between several");
    auto& mirror = call.gateway.mirror();
    const auto& rights = call.principal.rights;
    const auto view = view_of(rights);
    bus::Query query;
    query.find = bus::Find::kServices;
    query.board = pattern.substr(0, slash);
    query.service = pattern.substr(slash + 1);
    query.limit = bus::Query::kMaxPage;
    do {
        const auto page = mirror.find(query, call.now(), rights.limited() ? &view : nullptr);
        if (!page) return fail("values: " + page.error());
        for (const auto& item : page->services) {
            if (!snapshot.part.takes(item.board) || !rights.sees_service(item.board, item.name)) continue;
            add_values(call, item.board, item.name, snapshot.values);
            if (snapshot.values.size() <= metrics::kMaxValues) continue;
            snapshot.values.resize(metrics::kMaxValues);
            snapshot.values_left_out = true;
            return {};
        }
        query.cursor = page->cursor;
    } while (!query.cursor.empty());
    return {};
}

/// What the parameters `part` and `values` ask for.
Expected<void> read_parameters(Call& call, metrics::Snapshot& snapshot) {
    if (const auto* text = call.request.parameter("part")) {
        const auto part = metrics::Part::parse(*text);
        if (!part) return fail(part.error());
        snapshot.part = *part;
    }
    const auto* text = call.request.parameter("values");
    if (text == nullptr) return {};
    std::size_t count = 0;
    for (std::size_t at = 0; at <= text->size() && !snapshot.values_left_out;) {
        if (++count > kMaxPatterns)
            return fail("values: at most " + std::to_string(kMaxPatterns) + " patterns");
        const auto comma = std::min(text->find(',', at), text->size());
        if (auto added = add_pattern(call, std::string_view(*text).substr(at, comma - at), snapshot); !added)
            return added;
        at = comma + 1;
    }
    metrics::drop_repeated(snapshot.values);
    return {};
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
    if (const auto read = read_parameters(call, snapshot); !read)
        return send_problem(call, 400, read.error());
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
    snapshot.services_by_kind = mirror.services_by_kind(view);
    if (!rights.limited()) {  // what registries count is of all boards
        for (const auto& [id, info] : mirror.registries())
            snapshot.registries.emplace_back(id, info.stats);
    }
    for (const auto& [board, info] : mirror.board_stats()) {
        if (snapshot.part.takes(board) && rights.sees_board(board))
            snapshot.boards.emplace_back(board, info.text);
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
