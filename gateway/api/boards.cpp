// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "asip/bus/registry/query.hpp"
#include "asip/model/board_state.hpp"
#include "asip/model/json.hpp"
#include "gateway/api/limits.hpp"
#include "gateway/api/routes.hpp"

namespace asip::gateway::api {
namespace {

using nlohmann::json;

/// While the broker is away what is known is old: since when stands in the answer, a JSON object.
std::string with_doubt(const Call& call, std::string text) {
    const auto& mirror = call.gateway.mirror();
    if (mirror.connected() || mirror.connected_since().wall == text::WallTime{}) return text;
    text.pop_back();
    return text + R"(,"not_known_since":")" + text::iso_time(mirror.connected_since().wall) + "\"}";
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
    auto query = query_of(call, find);
    if (!query) return send_problem(call, 400, query.error());
    if (query->full) query->limit = std::min(query->limit, bus::Query::kMaxFullPage);
    const bool by_time = query->sort.ends_with("last_seen");
    const auto etag = catalogue_etag(call);
    if (!by_time && not_modified(call, etag)) return;
    const auto& rights = call.principal.rights;
    const auto view = view_of(rights);
    auto answer = call.gateway.mirror().find(*query, call.now(), rights.limited() ? &view : nullptr);
    if (!answer) return send_problem(call, 400, answer.error());
    limit_to(rights, *answer);
    auto response = text_response(with_doubt(call, bus::encode(*answer)));
    if (!by_time) response.headers.emplace_back("ETag", "W/" + etag);
    call.reply.send(std::move(response));
}

/// A page of the history that one asker sees. What several patterns let pass the registry cannot say: of its
/// pages those items are taken that are seen, page after page until there are enough.
struct HistoryPage : std::enable_shared_from_this<HistoryPage> {
    static constexpr int kMaxPages = 20;  // then what was found is the answer, and its cursor goes on

    HistoryPage(const Call& call, std::size_t wanted)
        : gateway(call.gateway),
          reply(call.reply),
          rights(call.principal.rights),
          client(call.client()),
          limit(wanted) {}

    void ask() {
        json query{{"find", "history"}, {"limit", limit - page.history.size()}};
        if (!board.empty()) query["board"] = board;
        if (!cursor.empty()) query["cursor"] = cursor;
        const bool asked = gateway.ask_registry(
            model::dump_json(query), client,
            [self = shared_from_this()](const bus::Answer* answer) { self->answered(answer); });
        if (!asked) reply.send(problem(429, "too many questions of yours are under way"));
    }

    void answered(const bus::Answer* answer) {
        if (answer == nullptr) return reply.send(problem(503, "no registry answers; history is kept by one"));
        if (answer->refused == "no-history") return reply.send(problem(404, answer->error));
        if (!answer->refused.empty()) return reply.send(problem(400, answer->error));
        if (reply.gone()) return;
        auto items = std::move(page.history);
        std::copy_if(answer->history.begin(), answer->history.end(), std::back_inserter(items),
                     [&](const auto& item) { return sees(rights, item); });
        page = *answer;
        page.id.clear();
        page.history = std::move(items);
        cursor = answer->cursor;
        const bool enough = page.history.size() >= limit || cursor.empty() || ++pages == kMaxPages;
        if (rights.limited() && !enough) return ask();
        reply.send(text_response(bus::encode(page)));
    }

    Gateway& gateway;
    http::Reply reply;
    Rights rights;
    std::string client;
    std::size_t limit;
    std::string board;  // empty: all
    std::string cursor;
    int pages = 0;
    bus::Answer page;
};

void ask_history(Call& call, const std::string& board) {
    if (!bus_is_there(call)) return;
    const auto limit = whole_parameter(call, "limit", 100, 1, 1000);
    if (!limit) return send_problem(call, 400, limit.error());
    const auto page = std::make_shared<HistoryPage>(call, static_cast<std::size_t>(*limit));
    const auto& patterns = call.principal.rights.boards;
    page->board = board.empty() && patterns.size() == 1 ? patterns.front() : board;
    if (const auto* cursor = call.request.parameter("cursor")) page->cursor = *cursor;
    page->ask();
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
    const auto etag = catalogue_etag(call);
    if (not_modified(call, etag)) return;
    auto answer = call.gateway.mirror().find(query, call.now());
    if (!answer || answer->boards.empty()) return void(board_of(call));
    const auto& rights = call.principal.rights;
    auto& board = answer->boards[0];
    limit_to(rights, board);
    auto response =
        text_response(with_doubt(call, rights.services.empty() ? call.gateway.board_texts().text(board)
                                                               : model::dump_json(bus::to_json(board))));
    response.headers.emplace_back("ETag", "W/" + etag);
    call.reply.send(std::move(response));
}

void delete_board(Call& call) {
    if (!bus_is_there(call)) return;
    const auto board = board_of(call);
    if (!board) return;
    if (!model::is_gone(board->state)) {
        return send_problem(call, 409,
                            "board \"" + board->board + "\" is " + board->state +
                                " and would be back with its next announcement; stop its agent first");
    }
    auto reply = call.reply;
    const auto forgotten = [reply](const bus::Answer* answer) {
        if (answer == nullptr)
            return reply.send(problem(503, "no registry answers; it is the registry that forgets boards"));
        if (answer->refused == "alive") return reply.send(problem(409, answer->error));
        if (answer->refused == "unknown-board") return reply.send(problem(404, answer->error));
        if (!answer->refused.empty()) return reply.send(problem(503, answer->error));
        reply.send(json_response({{"forgotten", answer->forgotten}}));
    };
    if (!call.gateway.ask_registry(model::dump_json({{"forget", board->board}}), call.client(), forgotten,
                                   bus::forget_topic(call.gateway.mirror().topics())))
        send_problem(call, 429, "too many questions of yours are under way");
}

void get_board_history(Call& call) {
    if (board_of(call)) ask_history(call, call.board());
}

void get_history(Call& call) {
    ask_history(call, {});
}

}  // namespace asip::gateway::api
