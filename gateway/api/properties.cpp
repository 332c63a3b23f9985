// SPDX-License-Identifier: Apache-2.0
// What can be read and set on a board, and how it stands.
#include <nlohmann/json.hpp>

#include "asip/bus/registry/longest.hpp"
#include "asip/bus/registry/query.hpp"
#include "asip/model/json.hpp"
#include "asip/property/documents.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"
#include "asip/text/wall_time.hpp"
#include "gateway/api/limits.hpp"
#include "gateway/api/routes.hpp"
#include "gateway/api/streams.hpp"

namespace asip::gateway::api {
namespace {

constexpr std::int64_t kMaxPast = 600;

/// A board as its asker sees it, with those of its properties that `ids` names.
struct Asked {
    Things::Found found;
    std::set<std::string, std::less<>> ids;  // empty: all

    bool wants(const property::Property& property) const { return ids.empty() || ids.contains(property.id); }
};

/// Or a 404 that names the nearest.
std::optional<Asked> asked(const Call& call, const std::string& one = {}) {
    const auto board = board_of(call);
    if (!board) return std::nullopt;
    auto found = call.gateway.things().find(call.gateway.mirror(), call.board(), call.now());
    if (!found) {
        send_problem(call, 404, "board \"" + call.board() + "\" has no description, so no properties");
        return std::nullopt;
    }
    Asked result{std::move(*found), {}};
    result.found.board = seen(call.principal.rights, std::move(result.found.board));
    const auto* text = one.empty() ? call.request.parameter("ids") : &one;
    for (std::size_t at = 0; text != nullptr && at <= text->size();) {
        const auto comma = std::min(text->find(',', at), text->size());
        result.ids.insert(text->substr(at, comma - at));
        at = comma + 1;
    }
    std::vector<std::string> known;
    for (const auto& each : result.found.board->properties)
        known.push_back(each.id);
    for (const auto& id : result.ids) {
        if (std::find(known.begin(), known.end(), id) != known.end()) continue;
        send_problem(call, 404,
                     "board " + call.board() + " has no property \"" + text::printable(id) + "\"" +
                         text::did_you_mean(id, known));
        return std::nullopt;
    }
    return result;
}

}  // namespace

void get_board_properties(Call& call) {
    property::PropertyList list;
    if (!board_of(call)) return;
    // A board that takes part by its names only has none.
    if (!call.gateway.things().find(call.gateway.mirror(), call.board(), call.now())) {
        list.head = {call.board(), {}, 0};
        return call.reply.send(text_response(property::to_text(list, property::Members::kAll)));
    }
    const auto board = asked(call);
    if (!board) return;
    list.head = {call.board(), board->found.session, 0};
    for (const auto& each : board->found.board->properties)
        if (board->wants(each)) list.properties.push_back(each);
    call.reply.send(text_response(property::to_text(list, property::Members::kAll)));
}

void get_board_values(Call& call) {
    const auto past = whole_parameter(call, "past", 0, 0, kMaxPast);
    if (!past) return send_problem(call, 400, past.error());
    const auto board = asked(call);
    if (!board) return;
    auto text = values_text(
        call.gateway.mirror(), *board->found.board, board->found.session,
        [&](const auto& each) { return board->wants(each); }, call.now());
    text.pop_back();
    text += std::string(",\"present\":") + (model::takes_commands(board->found.state) ? "true" : "false");
    if (*past > 0) {
        auto points = nlohmann::json::object();
        for (const auto& each : board->found.board->properties) {
            if (!board->wants(each)) continue;
            auto known = past_of(call.gateway.mirror(), call.board(), each, static_cast<std::size_t>(*past));
            if (!known.empty()) points[each.id] = std::move(known);
        }
        text += ",\"past\":" + points.dump();
    }
    text += '}';
    call.reply.send(text_response(std::move(text)));
}

void put_board_values(Call& call) {
    if (!board_of(call)) return;
    const auto body = model::parse_json(call.request.body, {.max_bytes = 1024, .max_depth = 3});
    if (!body || !body->is_object() || body->size() != 1)
        return send_problem(call, 400, "the body must be one property and its value: {\"io/13\":true}");
    const auto& id = body->begin().key();
    const auto board = asked(call, id);
    if (!board) return;
    for (const auto& each : board->found.board->properties)
        if (each.id == id)
            return set_property(call, board->found, each,
                                property::value_of_control(each, body->begin().value()));
    send_problem(call, 404, "board " + call.board() + " has no property \"" + text::printable(id) + "\"");
}

void get_board_values_stream(Call& call) {
    if (!board_of(call) || !bus_is_there(call) || !has_room(call)) return;
    const auto max_hz = number_parameter(call, "max_hz", 0, 0, kMaxHz);
    if (!max_hz) return send_problem(call, 400, max_hz.error());
    start_sse(call, std::make_unique<PropertyFeed>(call.gateway.mirror(),
                                                   feed_options(call, call.board(), "*", *max_hz)));
}

namespace {

/// Each registry keeps values for itself: the one that knew for the longest counts.
struct LongestKept {
    http::Reply reply;
    text::WallTime to;
    std::size_t waiting;
    std::optional<bus::Answer> best{};

    void take(const bus::Answer* answer) {
        const auto better = [&] {
            if (!best) return true;
            if (!answer->refused.empty() || !best->refused.empty()) return answer->refused.empty();
            return bus::known_time(*answer, to) > bus::known_time(*best, to);
        };
        if (answer != nullptr && better()) best = *answer;
        if (--waiting > 0) return;
        if (!best) return reply.send(problem(503, "no registry answers; values are kept by one"));
        if (!best->refused.empty())
            return reply.send(problem(best->refused == "no-history" ? 404 : 503, best->error));
        best->id.clear();
        reply.send(text_response(bus::encode(*best)));
    }
};

void ask_each_registry(Call& call, const nlohmann::json& query) {
    const auto& mirror = call.gateway.mirror();
    std::vector<std::string> topics;
    for (const auto& [id, info] : mirror.registries())
        if (info.state == "online") topics.push_back(mirror.topics().registry_query(id));
    if (topics.size() < 2) topics = {mirror.topics().any_registry_query()};
    const auto to = text::parse_iso_time(query["to"].get<std::string>()).value_or(call.now().wall);
    const auto longest = std::make_shared<LongestKept>(LongestKept{call.reply, to, topics.size()});
    bool room = true;
    for (const auto& topic : topics) {
        room = room && call.gateway.ask_registry(
                           model::dump_json(query), call.client(),
                           [longest](const bus::Answer* answer) { longest->take(answer); }, topic);
        if (!room) --longest->waiting;
    }
    if (longest->waiting == 0) send_problem(call, 429, "too many questions of yours are under way");
}

}  // namespace

void ask_kept(Call& call, const std::string& board, const std::string& property, text::WallTime oldest) {
    const auto points = whole_parameter(call, "points", 500, 1, 1000);
    if (!points) return send_problem(call, 400, points.error());
    const auto* from = call.request.parameter("from");
    const auto* to = call.request.parameter("to");
    const auto end = to == nullptr ? call.now().wall : text::parse_iso_time(*to).value_or(text::WallTime{});
    const auto begin =
        from == nullptr ? end - std::chrono::hours(24) : text::parse_iso_time(*from).value_or(oldest);
    nlohmann::json query{
        {"find", "values"},
        {"board", board},
        {"property", property},
        {"from", from == nullptr || begin < oldest ? text::iso_time(std::max(begin, oldest)) : *from},
        {"to", to == nullptr ? text::iso_time(end) : *to},
        {"points", static_cast<std::uint64_t>(*points)}};
    // The registry's words for what is wrong with them.
    if (const auto valid = bus::read_registry_request(query); !valid)
        return send_problem(call, 400, valid.error());
    if (bus_is_there(call)) ask_each_registry(call, query);
}

void get_board_values_kept(Call& call) {
    const auto* id = call.request.parameter("property");
    if (id == nullptr || id->empty())
        return send_problem(call, 400, "property: is missing; an id such as distance/0");
    if (asked(call, *id)) ask_kept(call, call.board(), *id, {});
}

}  // namespace asip::gateway::api
