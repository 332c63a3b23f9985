// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "asip/bus/request/request_envelope.hpp"
#include "asip/model/board_state.hpp"
#include "asip/model/json.hpp"
#include "asip/text/printable.hpp"
#include "gateway/api/routes.hpp"

namespace asip::gateway::api {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxWhyBytes = 200;

/// The answers of several boards, sent once all have come.
struct Answers {
    explicit Answers(http::Reply to) : reply(std::move(to)) {}

    http::Reply reply;
    json boards = json::object();
    std::size_t missing = 0;

    void answered(const std::string& board, const bus::Reply& answer) {
        boards[board] = json::parse(text_for_clients(answer), nullptr, false);
        boards[board].erase("id");
        if (--missing == 0) send();
    }
    void send() {
        const bool all = std::all_of(boards.begin(), boards.end(),
                                     [](const json& each) { return each.value("status", "") == "ok"; });
        reply.send(json_response({{"boards", std::move(boards)}}, all ? 200 : 207));
    }
};

/// What a stop says: it holds until the board is resumed, unless it is for once.
std::string stop_payload(const Call& call) {
    const auto* once = call.request.parameter("once");
    const auto* why = call.request.parameter("why");
    json payload = json::object();
    if (once == nullptr || *once != "true") payload["latch"] = true;
    if (why != nullptr && !why->empty()) payload["why"] = why->substr(0, kMaxWhyBytes);
    return model::dump_json(payload);
}

Commands::Start start_of(const Call& call, const std::string& board, const char* session) {
    Commands::Start start;
    start.session = session;
    start.by = call.principal.rights.name;
    start.target = board;
    start.client = call.client();
    return start;
}

void send_stop(const Call& call, const std::string& board, Commands::Done done) {
    auto start = start_of(call, board, "stop");
    start.topic = call.gateway.mirror().topics().stop(board);
    start.payload = stop_payload(call);
    start.urgent = true;
    call.gateway.command(std::move(start), std::move(done));
}

void send_resume(const Call& call, const std::string& board, Commands::Done done) {
    auto start = start_of(call, board, "resume");
    start.topic = call.gateway.mirror().topics().board_in(board);
    start.payload = R"({"resume":true})";
    call.gateway.command(std::move(start), std::move(done));
}

using Send = void (*)(const Call&, const std::string&, Commands::Done);

/// Asks each board and answers when all have answered; `known` is what is known before.
void ask_all(const Call& call, const std::vector<std::string>& boards, Send send,
             json known = json::object()) {
    auto answers = std::make_shared<Answers>(call.reply);
    answers->boards = std::move(known);
    answers->missing = boards.size();
    if (boards.empty()) return answers->send();
    for (const auto& board : boards) {
        send(call, board,
             [answers, board](const CommandRecord& record) { answers->answered(board, *record.reply); });
    }
}

/// The boards that the body names; nothing where it names none, which is all that the client sees.
Expected<std::optional<std::vector<std::string>>> named_boards(const Call& call) {
    std::optional<std::vector<std::string>> names;
    const auto& text = call.request.body;
    if (text.empty()) return names;
    const auto body = model::parse_json(text, {.max_bytes = text.size(), .max_depth = 3});
    if (!body) return fail("the body is not JSON: " + body.error());
    if (body->is_object() && body->empty()) return names;
    const auto list = body->is_object() ? body->find("boards") : body->end();
    if (!body->is_object() || body->size() != 1 || list == body->end() || !list->is_array() ||
        !std::all_of(list->begin(), list->end(), [](const json& each) { return each.is_string(); }))
        return fail(R"(the body must be {}, or name boards: {"boards":["uno1","uno2"]})");
    names = list->get<std::vector<std::string>>();
    std::sort(names->begin(), names->end());
    names->erase(std::unique(names->begin(), names->end()), names->end());
    return names;
}

void ask_named(const Call& call, std::vector<std::string> names, Send send) {
    json unknown = json::object();
    std::erase_if(names, [&](const std::string& name) {
        if (call.sees(name) && call.gateway.mirror().known(name, call.now())) return false;
        unknown[name] = {{"status", "refused"}, {"reason", "unknown-board"}, {"error", "no such board"}};
        return true;
    });
    ask_all(call, names, send, std::move(unknown));
}

}  // namespace

void post_stop_board(Call& call) {
    if (!bus_is_there(call)) return;
    const auto board = board_of(call);
    if (!board) return;
    ask_all(call, {board->board}, send_stop);
}

void post_stop(Call& call) {
    if (!bus_is_there(call)) return;
    auto names = named_boards(call);
    if (!names) return send_problem(call, 400, names.error());
    if (*names) return ask_named(call, std::move(**names), send_stop);
    auto boards = call.gateway.mirror().board_names();
    std::erase_if(boards, [&](const std::string& each) { return !call.sees(each); });
    stop_boards(call, boards);
}

// A board that is lost may have an agent that stops it once it is back: it is sent the stop, and not waited
// for.
void stop_boards(Call& call, const std::vector<std::string>& boards) {
    std::vector<std::string> alive, lost;
    for (const auto& board : boards) {
        const auto item = call.gateway.mirror().board(board, call.now());
        if (!item || item->names_only) continue;
        (model::is_gone(item->state) ? lost : alive).push_back(board);
    }
    ask_all(call, alive, send_stop);
    for (const auto& board : lost)
        send_stop(call, board, [](const CommandRecord&) {});
}

void post_resume_board(Call& call) {
    if (!bus_is_there(call)) return;
    const auto board = board_of(call);
    if (board) ask_all(call, {board->board}, send_resume);
}

// Those that are stopped, and have an agent that hears it.
void post_resume(Call& call) {
    if (!bus_is_there(call)) return;
    auto names = named_boards(call);
    if (!names) return send_problem(call, 400, names.error());
    if (*names) return ask_named(call, std::move(**names), send_resume);
    std::vector<std::string> stopped;
    for (auto& board : call.gateway.mirror().board_names()) {
        const auto item = call.gateway.mirror().known(board, call.now());
        if (item && item->reason == model::to_text(model::StateReason::kLatched) && call.sees(board))
            stopped.push_back(std::move(board));
    }
    ask_all(call, stopped, send_resume);
}

void post_renew(Call& call) {
    if (!bus_is_there(call)) return;
    const auto& id = call.path.find("id")->second;
    if (!session_is_valid(call)) return;
    const auto session = session_of(call);
    std::optional<std::int64_t> hold;
    if (call.request.parameter("hold_ms") != nullptr) {
        const auto ms = whole_parameter(call, "hold_ms", 0, 50, 60'000);
        if (!ms) return send_problem(call, 400, ms.error());
        hold = *ms;
    }
    if (!call.gateway.command_rates().take(call.client(), call.now().time))
        return send_problem(call, 429, "too many commands; try again in a moment");
    const auto topic = call.gateway.commands().topic_of(session, id);
    if (topic.empty())
        return send_problem(call, 404, "no command \"" + text::printable(id) + "\" of yours is known");
    json payload{{"renew", Commands::bus_id(session, id)}};
    if (hold) payload["hold_ms"] = *hold;
    Commands::Start start;
    start.session = session;
    start.by = call.principal.rights.name;
    start.target = id;
    start.topic = topic;
    start.payload = model::dump_json(payload);
    start.client = call.client();
    start.renewal = true;
    call.gateway.command(std::move(start),
                         [reply = call.reply, base = call.gateway.options().base_path](
                             const CommandRecord& record) { reply.send(response_for(record, base)); });
}

}  // namespace asip::gateway::api
