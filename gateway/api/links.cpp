// SPDX-License-Identifier: Apache-2.0
// Rules that agents execute: docs/links.md.
#include "asip/links/shown.hpp"

#include <nlohmann/json.hpp>

#include "asip/bus/request/request_envelope.hpp"
#include "asip/property/property.hpp"
#include "gateway/api/routes.hpp"

namespace asip::gateway::api {
namespace {

using nlohmann::json;

constexpr const char* kForm =
    R"(the body must be {"set":{"name":"warm","from":"desk/temperature","when":"above","level":30,"to":"io/5"}}, )"
    R"({"remove":"warm"}, {"enable":"warm"} or {"disable":"warm"})";

bool sees(const Call& call, const links::ShownLink& link) {
    const auto& rights = call.principal.rights;
    return rights.sees_service(link.link.board, property::service_of(link.link.source)) &&
           rights.sees_service(link.board, property::service_of(link.link.target));
}

/// "desk/io/2" of a link that is wanted, or the board of one that is there; empty: neither.
std::string source_board(const Call& call, const json& change) {
    if (const auto set = change.find("set"); set != change.end())
        return set->is_object() && set->contains("from") && (*set)["from"].is_string()
                   ? (*set)["from"].get<std::string>()
                   : std::string();
    const json& name = change.begin().value();
    const auto& texts = call.gateway.mirror().links();
    const auto found = texts.find(call.board());
    if (found != texts.end())
        for (const auto& each : links::read_shown(call.board(), found->second))
            if (name == json(each.link.name)) return each.link.board + "/";
    return {};
}

}  // namespace

void get_board_links(Call& call) {
    if (!board_of(call) || !bus_is_there(call)) return;
    json body{{"items", json::array()}};
    // Read is only what may be of this board: each source stands in a text of its own.
    const auto source = "\"" + call.board() + "/";
    for (const auto& [board, text] : call.gateway.mirror().links()) {
        const bool own = board == call.board();
        if (!own && text.find(source) == std::string::npos) continue;
        for (auto& each : links::read_shown(board, text)) {
            if ((!own && each.link.board != call.board()) || !sees(call, each)) continue;
            each.object["yours"] = call.principal.rights.may_label() && call.sees(each.link.board) &&
                                   each.link.user == bus::user_level(call.gateway.options().user);
            body["items"].push_back(std::move(each.object));
        }
        if (!own || call.principal.rights.limited()) continue;
        const auto document = json::parse(text, nullptr, false);
        if (document.is_object() && document.contains("set_aside")) body["set_aside"] = document["set_aside"];
    }
    send_json(call, body);
}

// What a link may be is the agent's to say.
void post_board_links(Call& call) {
    if (!bus_is_there(call)) return;
    const auto board = board_of(call);
    if (!board) return;
    const auto body = body_of(call.request);
    if (!body) return send_problem(call, 400, body.error());
    if (!body->is_object() || body->size() != 1) return send_problem(call, 400, kForm);
    const auto member = body->begin();
    const auto& what = member.key();
    const auto& value = member.value();
    const bool set = what == "set";
    if (!(set ? value.is_object()
              : value.is_string() && value != "*" &&
                    (what == "remove" || what == "enable" || what == "disable")))
        return send_problem(call, 400, kForm);
    if (const auto source = source_board(call, *body);
        !source.empty() && !call.sees(source.substr(0, source.find('/'))))
        return send_problem(
            call, set ? 403 : 404,
            set ? "you do not see the board of " + source : "there is no link " + value.get<std::string>());
    if (!has_agent(call, *board)) return;
    const auto& options = call.gateway.options();
    send(call, board->board,
         call.gateway.mirror().topics().link(board->board,
                                             bus::user_level(options.user) + "/" + options.client),
         *body);
}

}  // namespace asip::gateway::api
