// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "gateway/api/routes.hpp"

namespace asip::gateway::api {
namespace {

using nlohmann::json;

json registries_of(const Mirror& mirror) {
    json list = json::array();
    for (const auto& [id, info] : mirror.registries()) {
        json item{{"id", id}, {"state", info.state}};
        if (auto stats = model::parse_json(info.stats)) item["stats"] = std::move(*stats);
        list.push_back(std::move(item));
    }
    return list;
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
             {"forget", rights.may_forget()}};
    send_json(call, {{"version", ASIP_VERSION},
                     {"you", std::move(you)},
                     {"broker",
                      {{"address", gateway.options().broker},
                       {"connected", mirror.connected()},
                       {"since", text::iso_time(mirror.connected_since().wall)}}},
                     {"mirror",
                      {{"complete", mirror.complete()},
                       {"source", "bus"},
                       {"boards", mirror.size()},
                       {"epoch", mirror.epoch()}}},
                     {"registries", registries_of(mirror)},
                     {"streams",
                      {{"clients", gateway.streams().size()}, {"left_out", mirror.values().left_out()}}}});
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

// A code for whoever asks, with the same rights: `asipctl open` puts it behind the page's address.
void post_code(Call& call) {
    const auto code = call.gateway.gate().logins().make_code(call.principal.rights, call.now().time);
    if (code.empty()) return send_problem(call, 429, "too many codes are open; they last 30 s");
    auto response = json_response({{"code", code}, {"expires_in", 30}});
    response.headers = {{"Cache-Control", "no-store"}};
    call.reply.send(std::move(response));
}

void delete_session(Call& call) {
    auto& gate = call.gateway.gate();
    gate.logins().end(gate.cookie_of(call.request));
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
