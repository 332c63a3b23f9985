// SPDX-License-Identifier: Apache-2.0
#include "gateway/api/call.hpp"

#include <charconv>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"
#include "gateway/api/routes.hpp"
#include "gateway/auth/secret.hpp"

namespace asip::gateway::api {

using nlohmann::json;

namespace {

constexpr const char* kOneAsker = "private, no-cache";
constexpr const char* kVary = "Authorization, Cookie";
constexpr std::size_t kSessionDigits = 16;
constexpr std::size_t kMaxSessionNames = 1000;
constexpr std::size_t kMaxSessionBytes = 64;

}  // namespace

std::string Call::client() const {
    return client_of(principal, peer);
}

http::Response text_response(std::string json_text, int status) {
    http::Response response;
    response.status = status;
    response.body = std::move(json_text);
    response.headers = {{"Cache-Control", kOneAsker}, {"Vary", kVary}};
    return response;
}

http::Response json_response(const json& body, int status) {
    return text_response(model::dump_json(body), status);
}

http::Response problem(int status, const std::string& detail, json members) {
    members["title"] = http::reason_phrase(status);
    members["status"] = status;
    members["detail"] = detail;
    http::Response response;
    response.status = status;
    response.content_type = "application/problem+json";
    response.body = model::dump_json(members);
    response.headers = {{"Cache-Control", "no-store"}};
    if (status == 429 || status == 503) response.headers.emplace_back("Retry-After", "1");
    return response;
}

http::Response problem(int status, const std::string& detail) {
    return problem(status, detail, json::object());
}

void send_problem(const Call& call, int status, const std::string& detail) {
    call.reply.send(problem(status, detail));
}

void send_not_there(const Call& call, const std::string& board, const std::string& state) {
    call.reply.send(problem(503, "board " + board + " is " + state,
                            {{"reason", std::string(bus::kRefusedBoardNotThere)}}));
}

void send_json(const Call& call, const json& body) {
    call.reply.send(json_response(body));
}

bool bus_is_there(const Call& call) {
    if (call.gateway.mirror().ready()) return true;
    send_problem(call, 503, "the broker is not connected, or what it retains is still being read");
    return false;
}

bool has_room(const Call& call) {
    if (call.gateway.streams().has_room(call.client())) return true;
    send_problem(call, 429, "too many streams and waits are open; close one");
    return false;
}

std::shared_ptr<const bus::BoardItem> board_of(const Call& call) {
    auto& mirror = call.gateway.mirror();
    const auto& name = call.board();
    if (call.sees(name)) {
        if (auto board = mirror.known(name, call.now())) return board;
    }
    auto names = mirror.board_names();
    std::erase_if(names, [&](const std::string& each) { return !call.sees(each); });
    send_problem(call, 404,
                 "no board \"" + text::printable(name) + "\" is known" + text::did_you_mean(name, names));
    return nullptr;
}

const bus::ServiceItem* service_of(const Call& call, const bus::BoardItem& board) {
    const auto& name = call.service();
    const auto seen = [&](const bus::ServiceItem& service) {
        return call.principal.rights.sees_service(board.board, service.name);
    };
    for (const auto& service : board.services)
        if (service.name == name && seen(service)) return &service;
    std::vector<std::string> names;
    for (const auto& service : board.services)
        if (seen(service)) names.push_back(service.name);
    send_problem(call, 404,
                 "board " + board.board + " has no service \"" + text::printable(name) + "\"" +
                     text::did_you_mean(name, names));
    return nullptr;
}

model::ModelPtr model_of(Gateway& gateway, const bus::BoardItem& board, const std::string& service) {
    return gateway.board_models().find(board, service, [&] {
        bus::Query query;
        query.board = board.board;
        query.full = true;
        const auto found = gateway.mirror().find(query, gateway.now());
        return found && !found->boards.empty() ? found->boards[0].description : std::string();
    });
}

std::string catalogue_etag(const Call& call) {
    constexpr std::size_t kDigits = 16;
    const auto& log = call.gateway.mirror().log();
    std::string etag = "\"" + log.epoch() + "-" + std::to_string(log.last());
    if (const auto seen = call.principal.rights.seen(); !seen.empty())
        etag += "-" + hash_of(seen).substr(0, kDigits);
    return etag + "\"";
}

bool not_modified(const Call& call, const std::string& etag) {
    const auto known = call.request.header("if-none-match");
    if (known.empty() || known.find(etag) == std::string_view::npos) return false;
    http::Response response;
    response.status = 304;
    response.headers = {{"ETag", "W/" + etag}, {"Cache-Control", kOneAsker}, {"Vary", kVary}};
    call.reply.send(std::move(response));
    return true;
}

namespace {

template <class Number>
Expected<Number> parameter(const Call& call, std::string_view name, Number fallback, Number min, Number max,
                           const char* kind) {
    const auto* text = call.request.parameter(name);
    if (text == nullptr) return fallback;
    Number value{};
    const auto* end = text->data() + text->size();
    const auto [rest, error] = std::from_chars(text->data(), end, value);
    if (error != std::errc() || rest != end || !(value >= min && value <= max)) {
        const auto shown = [](Number bound) { return std::to_string(static_cast<std::int64_t>(bound)); };
        return fail(std::string(name) + ": must be a " + kind + " from " + shown(min) + " to " + shown(max));
    }
    return value;
}

}  // namespace

Expected<double> number_parameter(const Call& call, std::string_view name, double fallback, double min,
                                  double max) {
    return parameter(call, name, fallback, min, max, "number");
}

Expected<std::int64_t> whole_parameter(const Call& call, std::string_view name, std::int64_t fallback,
                                       std::int64_t min, std::int64_t max) {
    return parameter(call, name, fallback, min, max, "whole number");
}

const std::string& session_name(Gateway& gateway, const std::string& who) {
    auto& names = gateway.session_names();
    if (const auto found = names.find(who); found != names.end()) return found->second;
    if (names.size() >= kMaxSessionNames) names.clear();
    return names[who] = hash_of(who).substr(0, kSessionDigits);
}

bool valid_session(std::string_view name) {
    return name.size() <= kMaxSessionBytes;
}

bool session_is_valid(const Call& call) {
    if (valid_session(call.request.header("asip-session"))) return true;
    send_problem(call, 400, "Asip-Session: " + kSessionForm);
    return false;
}

std::string session_of(const Call& call) {
    return session_name(call.gateway,
                        call.client() + "\n" + std::string(call.request.header("asip-session")));
}

}  // namespace asip::gateway::api
