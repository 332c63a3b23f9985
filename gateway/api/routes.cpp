#include "gateway/api/routes.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "asip/program/log.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"

namespace asip::gateway::api {
namespace {

namespace log = program::log;

constexpr std::string_view kText = R"({"type":"string"})";
constexpr std::string_view kTruth = R"({"type":"boolean"})";

std::vector<Parameter> query_parameters(bool boards) {
    std::vector<Parameter> result{
        {"board", kText, "Pattern of board names: `*` any text, `?` any one character", R"("uno*")"},
        {"service", kText, "Pattern of service names", R"("dist*")"},
        {"kind", kText, "Names of service models, with commas between them", R"("distance")"},
        {"state", kText, "Effective states, with commas between them", R"("online")"},
        {"chip", kText, "Pattern", R"("ATmega*")"},
        {"sketch", kText, "Pattern", R"("*")"},
        {"unit", kText, "Some event or command of the service has this unit", R"("cm")"},
        {"capability", R"({"type":"string","enum":["digital","analog","pwm"]})", "Some pin can do this",
         R"("pwm")"},
        {"sort",
         R"({"type":"string","enum":["name","-name","state","-state","chip","-chip","sketch","-sketch","last_seen","-last_seen"]})",
         "Order", R"("-name")"},
        {"limit", R"({"type":"integer","minimum":1})", "Items a page, at most 1000", "10"},
        {"cursor", kText, "Where the next page begins, as the page before said", ""},
        {"count", kTruth, "Give `total` even where it costs a scan", "true"}};
    if (boards) {
        result.push_back({"full", kTruth, "Boards with their whole description", "true"});
        result.push_back({"brief", kTruth, "Boards as rows with only what a table shows", "false"});
    }
    return result;
}

const Parameter kDeadline{"deadline_ms", R"({"type":"integer","minimum":50,"maximum":60000})",
                          "Within what time the answer is needed", "1000"};
const Parameter kHold{"hold_ms", R"({"type":"integer","minimum":50,"maximum":60000})",
                      "Undo the command unless it is renewed within this time", ""};
const Parameter kLastEventId{"last_event_id", kText, "As the header Last-Event-ID", ""};

std::vector<Answer> command_answers() {
    return {{200, "Executed; `proof` says how that is known", "CommandAnswer"},
            {400, "Refused: `invalid`", "Problem", "application/problem+json"},
            {404, "No such board, service or command", "Problem", "application/problem+json"},
            {409, "Refused: `id-reused` or `stopped`", "Problem", "application/problem+json"},
            {422, "The board refused it: `code`, `error`", "Problem", "application/problem+json"},
            {429, "Too many commands, of one client or for the board (`queue-full`)", "Problem",
             "application/problem+json"},
            {503, "The board or the broker is not there", "Problem", "application/problem+json"},
            {504, "No proof in time: it may or may not have been executed", "Problem",
             "application/problem+json"}};
}

const Answer kNotFound{404, "No such board, service or other thing; the nearest name is said", "Problem",
                       "application/problem+json"};
const Answer kNotReady{503, "The broker is not connected", "Problem", "application/problem+json"};
const Answer kTooMany{429, "Too many; Retry-After says when to try again", "Problem",
                      "application/problem+json"};
const Answer kUnchanged{304, "Unchanged since the ETag that was sent", ""};

std::vector<Route> make_routes() {
    return {
        {"GET",
         "/api/boards",
         "listBoards",
         "Boards that match, page by page",
         Need::kRead,
         query_parameters(true),
         "",
         {{200, "One page", "Page"}, kUnchanged},
         get_boards},
        {"GET",
         "/api/boards/{board}",
         "getBoard",
         "One board with its description",
         Need::kRead,
         {},
         "",
         {{200, "The board", "Board"}, kUnchanged, kNotFound},
         get_board},
        {"DELETE",
         "/api/boards/{board}",
         "forgetBoard",
         "Forget a board that is lost or offline",
         Need::kForget,
         {},
         "",
         {{200, "Forgotten", "Forgotten"},
          kNotFound,
          {409, "The board lives", "Problem", "application/problem+json"},
          kNotReady},
         delete_board},
        {"GET",
         "/api/boards/{board}/history",
         "getBoardHistory",
         "What a registry keeps of its changes",
         Need::kRead,
         {{"limit", R"({"type":"integer","minimum":1,"maximum":1000})", "Items a page", "10"},
          {"cursor", kText, "Of the page before", ""}},
         "",
         {{200, "One page, the newest first", "Page"}, kNotFound, kNotReady},
         get_board_history},
        {"GET",
         "/api/history",
         "getHistory",
         "Changes of all boards that a registry keeps",
         Need::kRead,
         {{"limit", R"({"type":"integer","minimum":1,"maximum":1000})", "Items a page", "10"},
          {"cursor", kText, "Of the page before", ""}},
         "",
         {{200, "One page, the newest first", "Page"}, kNotFound, kNotReady},
         get_history},
        {"GET",
         "/api/services",
         "listServices",
         "Services that match, page by page",
         Need::kRead,
         query_parameters(false),
         "",
         {{200, "One page", "Page"}, kUnchanged},
         get_services},
        {"GET",
         "/api/boards/{board}/services/{service}",
         "getService",
         "A service with its model",
         Need::kRead,
         {},
         "",
         {{200, "The service", "Service"}, kNotFound},
         get_service},
        {"GET",
         "/api/boards/{board}/services/{service}/value",
         "getValue",
         "The last value of each event; or the next, with `wait`",
         Need::kRead,
         {{"wait", R"({"type":"number","minimum":0,"maximum":60})", "Seconds to wait for the next value",
           "0"},
          {"after", kText, "Answer at once when there is a value behind this place", ""}},
         "",
         {{200, "Values by event", "Value"}, kNotFound, kNotReady},
         get_value},
        {"GET",
         "/api/boards/{board}/services/{service}/values",
         "getValues",
         "Recent values",
         Need::kRead,
         {{"since", kText, "A place or a time: only what came behind it", ""}},
         "",
         {{200, "The oldest first", "Values"}, kNotFound},
         get_values},
        {"POST",
         "/api/boards/{board}/services/{service}/commands/{command}",
         "sendCommand",
         "Send a command and wait for its answer",
         Need::kCommand,
         {kDeadline, kHold},
         "Arguments",
         command_answers(),
         post_command},
        {"POST",
         "/api/boards/{board}/raw",
         "sendRaw",
         "Send ASIP request lines",
         Need::kRaw,
         {kDeadline},
         "RawLines",
         command_answers(),
         post_raw},
        {"GET",
         "/api/commands/{id}",
         "getCommand",
         "What became of a command of yours; kept for a minute",
         Need::kCommand,
         {},
         "",
         {{200, "The command, with its answer if there is one", "Command"}, kNotFound},
         get_command},
        {"POST",
         "/api/commands/{id}/renew",
         "renewCommand",
         "Go on holding a command that was sent with `hold_ms`",
         Need::kCommand,
         {kHold},
         "",
         {{200, "Held for another while", "CommandAnswer"},
          {404, "No command of yours has this id", "Problem", "application/problem+json"},
          {409, "It is not held: `not-held`", "Problem", "application/problem+json"},
          kNotReady,
          {504, "Nobody answered", "Problem", "application/problem+json"}},
         post_renew},
        {"POST",
         "/api/boards/{board}/stop",
         "stopBoard",
         "Bring everything on a board into its safe state, ahead of all that waits",
         Need::kCommand,
         {},
         "",
         {{200, "Stopped", "Stopped"},
          {207, "The board did not confirm it in time", "Stopped"},
          kNotFound,
          kNotReady},
         post_stop_board},
        {"POST",
         "/api/stop",
         "stopAll",
         "The same on every board",
         Need::kCommand,
         {},
         "",
         {{200, "All of them are stopped", "Stopped"},
          {207, "Some did not confirm it in time", "Stopped"},
          kNotReady},
         post_stop},
        {"GET",
         "/metrics",
         "getMetrics",
         "What agents, registries and this gateway count, for Prometheus",
         Need::kRead,
         {},
         "",
         {{200, "Metrics", "EventStream", "text/plain; version=0.0.4; charset=utf-8"}},
         get_metrics},
        {"GET",
         "/api/models",
         "listModels",
         "The service models",
         Need::kRead,
         {},
         "",
         {{200, "All of them", "Models"}},
         get_models},
        {"GET",
         "/api/models/{name}",
         "getModel",
         "One service model",
         Need::kRead,
         {},
         "",
         {{200, "The model", "Model"}, kNotFound},
         get_model},
        {"GET",
         "/api/events",
         "streamEvents",
         "Changes of the catalogue as Server-Sent Events",
         Need::kRead,
         {{"board", kText, "Pattern of board names", R"("*")"}, kLastEventId},
         "",
         {{200, "A stream without end", "EventStream", "text/event-stream"}, kNotReady, kTooMany},
         get_events},
        {"GET",
         "/api/boards/{board}/services/{service}/stream",
         "streamValues",
         "Values of a service as Server-Sent Events",
         Need::kRead,
         {{"max_hz", R"({"type":"number","minimum":0,"maximum":1000})", "The newest value at most so often",
           "20"},
          kLastEventId},
         "",
         {{200, "A stream without end", "EventStream", "text/event-stream"}, kNotFound, kNotReady, kTooMany},
         get_service_stream},
        {"GET",
         "/api/stream",
         "stream",
         "WebSocket: many subscriptions, commands and answers",
         Need::kRead,
         {{"session", kText, "Names the session to which ids of commands belong", ""}},
         "",
         {{101, "The protocol is WebSocket from here on", ""},
          {426, "No WebSocket was asked for", "Problem", "application/problem+json"},
          kTooMany},
         get_stream},
        {"GET",
         "/api/status",
         "getStatus",
         "Broker, registries, this gateway, and what you may do",
         Need::kRead,
         {},
         "",
         {{200, "How it is", "Status"}},
         get_status},
        {"POST",
         "/api/codes",
         "makeCode",
         "A code that logs a browser in, once, within 30 s",
         Need::kRead,
         {},
         "",
         {{200, "The code", "Code"}, kTooMany},
         post_code},
        {"DELETE",
         "/api/session",
         "endSession",
         "Log out",
         Need::kNothing,
         {},
         "",
         {{204, "Logged out", ""}},
         delete_session},
        {"GET",
         "/api/openapi.json",
         "getOpenapi",
         "This document",
         Need::kNothing,
         {},
         "",
         {{200, "OpenAPI 3.1", "Anything"}},
         get_openapi},
        {"GET",
         "/healthz",
         "getHealth",
         "Whether the gateway runs",
         Need::kNothing,
         {},
         "",
         {{200, "It runs", "Health"}},
         get_healthz},
        {"GET",
         "/readyz",
         "getReady",
         "Whether the bus is heard and the catalogue complete",
         Need::kNothing,
         {},
         "",
         {{200, "It is", "Health"}, kNotReady},
         get_readyz},
    };
}

bool fits(std::string_view pattern, const std::vector<std::string>& segments,
          std::map<std::string, std::string, std::less<>>& path) {
    path.clear();
    for (const auto& segment : segments) {
        if (pattern.empty()) return false;
        pattern.remove_prefix(1);
        const auto part = pattern.substr(0, pattern.find('/'));
        pattern.remove_prefix(part.size());
        if (!part.empty() && part.front() == '{')
            path.emplace(part.substr(1, part.size() - 2), segment);
        else if (part != segment)
            return false;
    }
    return pattern.empty();
}

bool allowed(const Rights& rights, Need need) {
    switch (need) {
        case Need::kNothing:
            return true;
        case Need::kRead:
            return rights.may_read();
        case Need::kCommand:
            return rights.may_command();
        case Need::kRaw:
            return rights.may_send_raw();
        case Need::kForget:
            return rights.may_forget();
    }
    return false;
}

void secure(http::Response& response, const std::string& origin) {
    response.headers.emplace_back("X-Content-Type-Options", "nosniff");
    response.headers.emplace_back("Referrer-Policy", "no-referrer");
    response.headers.emplace_back("Cross-Origin-Resource-Policy",
                                  origin.empty() ? "same-origin" : "cross-origin");
    if (origin.empty()) return;
    response.headers.emplace_back("Access-Control-Allow-Origin", origin);
    response.headers.emplace_back("Access-Control-Expose-Headers", "ETag, Location, Retry-After");
    response.headers.emplace_back("Vary", "Origin");
}

constexpr std::size_t kWorthCompressing = 1400;  // what fits into one packet gains nothing

struct Served {
    std::string origin;
    bool gzip = false;
};

http::Reply finished(const http::Reply& reply, Served served) {
    return reply.with([served = std::move(served)](http::Response& response) {
        if (served.gzip && !response.compressed && response.fixed.empty() &&
            response.body.size() >= kWorthCompressing) {
            response.body = http::compress(response.body);
            response.compressed = true;
            response.headers.emplace_back("Vary", "Accept-Encoding");
        }
        secure(response, served.origin);
    });
}

void preflight(const http::Request& request, const http::Reply& reply, const std::string& methods,
               bool foreign) {
    http::Response response;
    response.status = 204;
    response.headers = {{"Allow", methods}};
    if (foreign && request.has_header("access-control-request-method")) {
        response.headers.emplace_back("Access-Control-Allow-Methods", methods);
        response.headers.emplace_back(
            "Access-Control-Allow-Headers",
            "Authorization, Content-Type, Idempotency-Key, Last-Event-ID, Asip-Session");
        response.headers.emplace_back("Access-Control-Max-Age", "600");
    }
    reply.send(std::move(response));
}

bool known_parameters(const http::Request& request, const http::Reply& reply, const Route& route) {
    std::set<std::string> seen;
    for (const auto& [name, value] : request.query) {
        const auto known = std::any_of(route.query.begin(), route.query.end(),
                                       [&](const Parameter& each) { return each.name == name; });
        std::vector<std::string_view> names;
        for (const auto& parameter : route.query)
            names.push_back(parameter.name);
        std::string fault;
        if (!known) {
            fault =
                "there is no parameter \"" + text::printable(name) + "\"" + text::did_you_mean(name, names);
        } else if (!seen.insert(name).second && name != "kind" && name != "state") {
            fault = name + ": given twice";
        }
        if (fault.empty()) continue;
        reply.send(problem(400, fault));
        return false;
    }
    return true;
}

void refuse_right(const Principal& principal, const http::Reply& reply, Need need) {
    if (!principal.rights.may_read()) {
        auto response = problem(401, "a token is needed: Authorization: Bearer TOKEN, or asipctl open");
        response.headers.emplace_back("WWW-Authenticate", "Bearer realm=\"asip\"");
        return reply.send(std::move(response));
    }
    const std::string role(to_string(principal.rights.role));
    reply.send(problem(403, need == Need::kRaw
                                ? "a " + role + " without the right to raw lines may not do this"
                            : need == Need::kForget ? "only an admin may forget boards"
                                                    : "a " + role + " may only read"));
}

void log_change(const Call& call) {
    if (call.request.method != "POST" && call.request.method != "DELETE") return;
    log::info("request", {{"by", call.principal.rights.name},
                          {"from", call.request.peer.address},
                          {"method", call.request.method},
                          {"target", text::printable(call.request.target, 200)}});
}

bool within(const std::string& base, http::Request& request) {
    if (base.empty()) return true;
    const auto part = base.substr(1);
    if (request.segments.empty() || request.segments[0] != part) return false;
    request.segments.erase(request.segments.begin());
    return true;
}

void serve_route(Gateway& gateway, const http::Request& request, const http::Reply& reply,
                 const Expected<Principal, Denied>& principal) {
    std::map<std::string, std::string, std::less<>> path;
    std::string methods;
    const auto method = request.method == "HEAD" ? std::string("GET") : request.method;
    for (const auto& route : routes()) {
        if (!fits(route.path, request.segments, path)) continue;
        if (route.method != method) {
            methods += (methods.empty() ? "" : ", ") + std::string(route.method) +
                       (route.method == "GET" ? ", HEAD" : "");
            continue;
        }
        if (!allowed(principal->rights, route.need)) return refuse_right(*principal, reply, route.need);
        if (!known_parameters(request, reply, route)) return;
        Call call{gateway, request, reply, *principal, route, std::move(path)};
        log_change(call);
        return route.serve(call);
    }
    if (!methods.empty()) {
        methods += ", OPTIONS";
        if (method == "OPTIONS")
            return preflight(request, reply, methods, !gateway.gate().allowed_origin(request).empty());
        auto response = problem(405, "only " + methods);
        response.headers.emplace_back("Allow", methods);
        return reply.send(std::move(response));
    }
    const bool api = !request.segments.empty() && request.segments[0] == "api";
    if (api) return reply.send(problem(404, "there is nothing at this address; see /api/openapi.json"));
    serve_page(gateway, request, reply);
}

}  // namespace

const std::vector<Route>& routes() {
    static const std::vector<Route> all = make_routes();
    return all;
}

void serve(Gateway& gateway, const http::Request& received, const http::Reply& plain) {
    const http::Request* request = &received;
    http::Request inner;
    if (const auto& base = gateway.options().base_path; !base.empty()) {
        inner = received;
        if (!within(base, inner)) return plain.send(problem(404, "the gateway is at " + base + "/"));
        request = &inner;
    }
    const auto reply =
        finished(plain, {gateway.gate().allowed_origin(*request), http::accepts_gzip(*request)});
    const auto principal = gateway.gate().admit(*request, gateway.now());
    if (!principal) {
        auto response = problem(principal.error().status, principal.error().text);
        if (principal.error().status == 401)
            response.headers.emplace_back("WWW-Authenticate", "Bearer realm=\"asip\"");
        return reply.send(std::move(response));
    }
    if (request->segments == std::vector<std::string>{""})
        return reply.send(problem(404, "there is nothing at this address"));
    serve_route(gateway, *request, reply, principal);
}

}  // namespace asip::gateway::api
