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

/// A stop holds until the board is resumed, unless it is for once. What is known before is in `known`.
ManyBoards::Asked asked(const Call& call, bool stop, json known = json::object()) {
    const auto* once = call.request.parameter("once");
    const auto* why = call.request.parameter("why");
    ManyBoards::Asked result;
    result.stop = stop;
    // A pupil could not resume its board.
    result.latch = stop && call.principal.rights.may_resume() && (once == nullptr || *once != "true");
    if (stop && why != nullptr) result.why = why->substr(0, kMaxWhyBytes);
    result.by = call.principal.rights.name;
    result.client = call.client();
    result.known = std::move(known);
    return result;
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

void ask_named(const Call& call, std::vector<std::string> names, bool stop) {
    json unknown = json::object();
    std::erase_if(names, [&](const std::string& name) {
        if (call.sees(name) && call.gateway.mirror().known(name, call.now())) return false;
        unknown[name] = {{"status", "refused"}, {"reason", "unknown-board"}, {"error", "no such board"}};
        return true;
    });
    auto all = asked(call, stop, std::move(unknown));
    all.boards = std::move(names);
    call.gateway.many_boards().ask(std::move(all), call.reply);
}

void ask_one(const Call& call, const std::string& board, bool stop) {
    auto one = asked(call, stop);
    one.boards = {board};
    call.gateway.many_boards().ask(std::move(one), call.reply);
}

}  // namespace

void post_stop_board(Call& call) {
    if (!bus_is_there(call)) return;
    const auto board = board_of(call);
    if (board) ask_one(call, board->board, true);
}

void post_stop(Call& call) {
    if (!bus_is_there(call)) return;
    auto names = named_boards(call);
    if (!names) return send_problem(call, 400, names.error());
    if (*names) return ask_named(call, std::move(**names), true);
    auto boards = call.gateway.mirror().board_names();
    std::erase_if(boards, [&](const std::string& each) { return !call.sees(each); });
    stop_boards(call, boards);
}

// A board that is lost may have an agent that stops it once it is back: it is sent the stop, and not waited
// for.
void stop_boards(Call& call, const std::vector<std::string>& boards) {
    auto all = asked(call, true);
    for (const auto& board : boards) {
        const auto item = call.gateway.mirror().board(board, call.now());
        if (!item || item->names_only) continue;
        (model::is_gone(item->state) ? all.lost : all.boards).push_back(board);
    }
    std::sort(all.boards.begin(), all.boards.end());
    call.gateway.many_boards().ask(std::move(all), call.reply);
}

void post_resume_board(Call& call) {
    if (!bus_is_there(call)) return;
    const auto board = board_of(call);
    if (board) ask_one(call, board->board, false);
}

// Those that are stopped, and have an agent that hears it.
void post_resume(Call& call) {
    if (!bus_is_there(call)) return;
    auto names = named_boards(call);
    if (!names) return send_problem(call, 400, names.error());
    if (*names) return ask_named(call, std::move(**names), false);
    auto all = asked(call, false);
    for (auto& board : call.gateway.mirror().board_names()) {
        const auto item = call.gateway.mirror().known(board, call.now());
        if (item && item->reason == model::to_text(model::StateReason::kLatched) && call.sees(board))
            all.boards.push_back(std::move(board));
    }
    std::sort(all.boards.begin(), all.boards.end());
    call.gateway.many_boards().ask(std::move(all), call.reply);
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
