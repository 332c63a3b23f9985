// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "asip/bus/query.hpp"
#include "asip/model/json.hpp"
#include "gateway/api/limits.hpp"
#include "gateway/api/routes.hpp"

namespace asip::gateway::api {
namespace {

using nlohmann::json;

std::string etag_of(const Call& call) {
    const auto& log = call.gateway.mirror().log();
    return "\"" + log.epoch() + "-" + std::to_string(log.last()) + "\"";
}

void add_list(json& object, const std::string& name, const std::string& value) {
    auto& list = object[name];
    for (std::size_t at = 0; at <= value.size();) {
        const auto comma = std::min(value.find(',', at), value.size());
        list.push_back(value.substr(at, comma - at));
        at = comma + 1;
    }
}

// The parameters as the members of a registry's query, so that both check the same in the same words.
Expected<bus::Query> query_of(const Call& call, const char* find) {
    json object{{"find", find}};
    for (const auto& [name, value] : call.request.query) {
        if (name == "kind" || name == "state") {
            add_list(object, name, value);
        } else if (name == "limit") {
            const auto limit = whole_parameter(call, "limit", 100, 1, 1'000'000'000);
            if (!limit) return Unexpected<std::string>(limit.error());
            object[name] = static_cast<std::uint64_t>(*limit);
        } else if (name == "full" || name == "count" || name == "brief") {
            if (value != "true" && value != "false" && !value.empty())
                return fail(name + ": must be true or false");
            object[name] = value != "false";
        } else {
            object[name] = value;
        }
    }
    auto request = bus::read_registry_request(object);
    if (!request) return Unexpected<std::string>(request.error());
    return std::get<bus::Query>(*request);
}

void list(Call& call, const char* find) {
    const auto query = query_of(call, find);
    if (!query) return send_problem(call, 400, query.error());
    const bool by_time = query->sort.ends_with("last_seen");
    const auto etag = etag_of(call);
    if (!by_time && not_modified(call, etag)) return;
    auto answer = call.gateway.mirror().find(*query, call.now());
    if (!answer) return send_problem(call, 400, answer.error());
    limit_to(call.principal.rights, *answer);
    auto response = text_response(bus::encode(*answer));
    if (!by_time) response.headers.emplace_back("ETag", "W/" + etag);
    call.reply.send(std::move(response));
}

void ask_history(Call& call, const std::string& board) {
    if (!bus_is_there(call)) return;
    json query{{"find", "history"}};
    if (!board.empty()) query["board"] = board;
    const auto limit = whole_parameter(call, "limit", 100, 1, 1000);
    if (!limit) return send_problem(call, 400, limit.error());
    query["limit"] = *limit;
    if (const auto* cursor = call.request.parameter("cursor")) query["cursor"] = *cursor;
    auto reply = call.reply;
    auto rights = call.principal.rights;
    call.gateway.ask_registry(model::dump_json(query), [reply, rights](const bus::Answer* answer) {
        if (answer == nullptr) return reply.send(problem(503, "no registry answers; history is kept by one"));
        if (answer->refused == "no-history") return reply.send(problem(404, answer->error));
        if (!answer->refused.empty()) return reply.send(problem(400, answer->error));
        bus::Answer shown = *answer;
        shown.id.clear();
        limit_to(rights, shown);
        reply.send(text_response(bus::encode(shown)));
    });
}

}  // namespace

void get_boards(Call& call) {
    list(call, "boards");
}

void get_services(Call& call) {
    list(call, "services");
}

void get_board(Call& call) {
    if (!call.sees(call.board())) return void(board_of(call));
    bus::Query query;
    query.board = call.board();
    query.full = true;
    if (call.board().find_first_of("*?") != std::string::npos) return void(board_of(call));
    const auto etag = etag_of(call);
    if (not_modified(call, etag)) return;
    auto answer = call.gateway.mirror().find(query, call.now());
    if (!answer || answer->boards.empty()) return void(board_of(call));
    const auto& rights = call.principal.rights;
    auto& board = answer->boards[0];
    limit_to(rights, board);
    auto response = rights.services.empty() ? text_response(call.gateway.board_texts().text(board))
                                            : json_response(bus::to_json(board));
    response.headers.emplace_back("ETag", "W/" + etag);
    call.reply.send(std::move(response));
}

void delete_board(Call& call) {
    if (!bus_is_there(call)) return;
    const auto board = board_of(call);
    if (!board) return;
    if (board->state != "lost" && board->state != "offline") {
        return send_problem(call, 409,
                            "board \"" + board->board + "\" is " + board->state +
                                " and would be back with its next announcement; stop its agent first");
    }
    auto reply = call.reply;
    call.gateway.ask_registry(model::dump_json({{"forget", board->board}}), [reply](
                                                                                const bus::Answer* answer) {
        if (answer == nullptr)
            return reply.send(problem(503, "no registry answers; it is the registry that forgets boards"));
        if (answer->refused == "alive") return reply.send(problem(409, answer->error));
        if (answer->refused == "unknown-board") return reply.send(problem(404, answer->error));
        if (!answer->refused.empty()) return reply.send(problem(503, answer->error));
        reply.send(json_response({{"forgotten", answer->forgotten}}));
    });
}

void get_board_history(Call& call) {
    if (board_of(call)) ask_history(call, call.board());
}

void get_history(Call& call) {
    ask_history(call, {});
}

}  // namespace asip::gateway::api
