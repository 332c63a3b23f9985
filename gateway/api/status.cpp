// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include <numeric>

#include "asip/model/json.hpp"
#include "gateway/api/limits.hpp"
#include "gateway/api/routes.hpp"

namespace asip::gateway::api {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxUsers = 200;  // in an answer that a page asks for every ten seconds

json registries_of(const Mirror& mirror) {
    json list = json::array();
    for (const auto& [id, info] : mirror.registries()) {
        json item{{"id", id}, {"state", info.state}};
        if (auto stats = model::parse_json(info.stats)) item["stats"] = std::move(*stats);
        list.push_back(std::move(item));
    }
    return list;
}

json exports_of(const Gateway& gateway) {
    json list = json::array();
    for (const auto& each : gateway.exports()) {
        json item{{"system", each.system}, {"title", each.title}, {"on", each.on}, {"shows", each.shows}};
        if (!each.other.empty()) item["other"] = each.other;
        if (each.found) item["found"] = *each.found;
        list.push_back(std::move(item));
    }
    return list;
}

json users_of(const Tokens& tokens) {
    json list = json::array();
    for (const auto& each : tokens.all()) {
        if (list.size() == kMaxUsers) break;
        json item{{"name", each.name},
                  {"role", std::string(to_string(each.role)) + (each.raw ? "+raw" : "")}};
        if (each.until) item["until"] = text::iso_time(*each.until);
        if (!each.boards.empty()) item["boards"] = each.boards;
        if (!each.services.empty()) item["services"] = each.services;
        if (!each.dashboard.empty()) item["dashboard"] = each.dashboard;
        list.push_back(std::move(item));
    }
    return list;
}

std::size_t boards_seen(const Mirror& mirror, const Rights& rights) {
    if (!rights.limited()) return mirror.size();
    const auto by_state = mirror.boards_by_state(view_of(rights));
    return std::accumulate(by_state.begin(), by_state.end(), std::size_t{0});
}

}  // namespace

void get_status(Call& call) {
    auto& gateway = call.gateway;
    const auto& mirror = gateway.mirror();
    const auto& rights = call.principal.rights;
    json you{{"name", rights.name},
             {"role", to_string(rights.role)},
             {"raw", rights.may_send_raw()},
             {"command", rights.may_command()},
             {"stop", rights.may_stop()},
             {"label", rights.may_label()},
             {"forget", rights.may_forget()},
             {"arrange", rights.may_arrange()},
             {"resume", rights.may_resume()},
             {"limited", rights.limited()},
             {"lend", gateway.has_cables() && rights.may_lend()},
             {"session", call.principal.kind == Principal::Kind::kSession}};
    if (!rights.dashboard.empty()) {
        you["dashboard"] = rights.dashboard;
        you["control"] = rights.control;
    }
    if (!rights.lesson.empty())
        you["lesson"] = {{"pupil", rights.name.substr(0, rights.name.find('@'))},
                         {"board", rights.boards.front()},
                         {"lend", rights.may_lend()},
                         {"until", text::iso_time(*rights.until)}};
    json broker{{"connected", mirror.connected()}};
    // Where there never was a connection there is no such time.
    if (const auto since = mirror.connected_since().wall; since != text::WallTime{})
        broker["since"] = text::iso_time(since);
    json catalogue{{"complete", mirror.complete()},
                   {"source", "bus"},
                   {"boards", boards_seen(mirror, rights)},
                   {"epoch", mirror.epoch()}};
    json body{{"version", ASIP_VERSION}, {"you", std::move(you)}};
    // What is of no board that it shows is none of a limited token's: where the broker is, what else is
    // there.
    if (!rights.limited()) {
        broker["address"] = gateway.options().broker;
        body["registries"] = registries_of(mirror);
        body["streams"] = {{"clients", gateway.streams().size()}, {"left_out", mirror.values().left_out()}};
        body["exports"] = exports_of(gateway);
        body["simulator"] = gateway.options().simulator;
        if (rights.role == Role::kAdmin) body["users"] = users_of(gateway.gate().tokens());
    }
    body["broker"] = std::move(broker);
    body["mirror"] = std::move(catalogue);
    send_json(call, body);
}

void get_healthz(Call& call) {
    send_json(call, {{"status", "ok"}});
}

void get_readyz(Call& call) {
    const auto& mirror = call.gateway.mirror();
    if (!mirror.connected()) return send_problem(call, 503, "the broker is not connected");
    if (!mirror.complete()) return send_problem(call, 503, "what the broker retains is still being read");
    send_json(call, {{"status", "ok"}});
}

// A code for the client that asks, with the same rights: `asipctl open` puts it behind the page's address. A
// session that made codes could go on for ever, under cookies that no log-out ends.
void post_code(Call& call) {
    if (call.principal.kind == Principal::Kind::kSession)
        return send_problem(
            call, 403, "a browser that is signed in makes no codes; asipctl open makes one, with the token");
    if (call.principal.rights.role == Role::kKiosk)
        return send_problem(call, 403, "a kiosk's token opens its own link only, and makes no codes");
    const auto code = call.gateway.gate().logins().make_code(call.principal.rights, call.now().time);
    if (code.empty())
        return send_problem(call, 429,
                            "too many codes of " + call.principal.rights.name + " are open; they last 30 s");
    auto response = json_response({{"code", code}, {"expires_in", 30}});
    response.headers = {{"Cache-Control", "no-store"}};
    call.reply.send(std::move(response));
}

void delete_session(Call& call) {
    auto& gate = call.gateway.gate();
    const auto cookie = gate.cookie_of(call.request);
    gate.logins().end(cookie);
    gate.lessons(call.now()).leave(cookie);
    call.gateway.streams().end_those_without_right(call.now(), gate);
    http::Response response;
    response.status = 204;
    response.headers = {{"Set-Cookie", gate.options().cookie +
                                           "=; Max-Age=0; Path=" + call.gateway.options().base_path +
                                           "/; HttpOnly; SameSite=Strict"}};
    call.reply.send(std::move(response));
}

void get_openapi(Call& call) {
    call.reply.send(text_response(call.gateway.openapi()));
}

}  // namespace asip::gateway::api
