// SPDX-License-Identifier: Apache-2.0
// A board in the computer of a browser: the page is its cable.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/program/log.hpp"
#include "asip/text/printable.hpp"
#include "gateway/api/routes.hpp"
#include "gateway/cable/cable_channel.hpp"

namespace asip::gateway::api {
namespace {

using nlohmann::json;
namespace log = program::log;

constexpr std::size_t kNameDigits = 16;
constexpr const char* kHexDigits = "0123456789abcdef";

bool is_usb_number(const std::string& text) {
    return text.size() == 4 && text.find_first_not_of(kHexDigits) == std::string::npos;
}

/// Answers 400 and returns false where a parameter is wrong.
bool read_port(const Call& call, json& hello) {
    for (const char* name : {"vendor", "product"}) {
        const auto* given = call.request.parameter(name);
        if (given == nullptr) continue;
        if (!is_usb_number(*given)) {
            send_problem(call, 400, std::string(name) + ": four hexadecimal digits in lower case: 2341");
            return false;
        }
        hello[name] = *given;
    }
    const auto* name = call.request.parameter("cable");
    if (name == nullptr) return true;
    if (name->size() != kNameDigits || name->find_first_not_of(kHexDigits) != std::string::npos) {
        send_problem(call, 400, "cable: sixteen hexadecimal digits in lower case");
        return false;
    }
    hello["cable"] = *name;
    return true;
}

}  // namespace

bool has_cables(const Call& call) {
    if (call.gateway.has_cables()) return true;
    send_problem(call, 404,
                 "no agent takes lent boards here; start asip-agent and asip-gateway with --cables FOLDER");
    return false;
}

void get_cable(Call& call) {
    auto& gateway = call.gateway;
    if (!http::is_upgrade(call.request)) {
        auto response = problem(426, "this is a WebSocket, the cable to a board");
        response.headers.emplace_back("Upgrade", "websocket");
        return call.reply.send(std::move(response));
    }
    if (!has_cables(call)) return;
    const auto& by = call.principal.rights.name;
    json hello{{"by", by}};
    if (const auto& place = call.principal.rights.place; !place.empty()) hello["place"] = place;
    if (!read_port(call, hello) || !has_room(call)) return;
    CableChannel::Dependencies needs;
    needs.part = call.part();
    if (!needs.part.set(gateway.options().socket_bytes + CableChannel::kMaxWaiting))
        return send_problem(call, 429, "too much is kept for this client (max-client-bytes)");
    needs.now = [&gateway] { return gateway.now(); };
    needs.open = [&gateway](CableWay::Handlers handlers) { return gateway.cable(std::move(handlers)); };
    needs.hello = hello.dump(-1, ' ', false, json::error_handler_t::replace);
    const auto said = [&gateway, by, client = call.client(), from = call.peer.address](
                          const char* what, const char* name, const std::string& value) {
        if (gateway.log_rates().take(client, gateway.now().time))
            log::info(what, {{"by", by}, {"from", from}, {name, text::printable(value)}});
    };
    needs.named = [said](const std::string& board) { said("board lent", "board", board); };
    needs.ended = [said](const std::string& why) { said("board not lent any more", "why", why); };
    call.reply.websocket(
        std::make_unique<CableChannel>(gateway.streams(), std::move(needs), call.principal, call.client()));
}

}  // namespace asip::gateway::api
