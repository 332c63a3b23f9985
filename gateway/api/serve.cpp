// SPDX-License-Identifier: Apache-2.0
// A request to its route: its rights, its parameters, what every response carries.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "asip/program/log.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"
#include "gateway/api/routes.hpp"
#include "gateway/http/address.hpp"

namespace asip::gateway::api {
namespace {

namespace log = program::log;

bool allowed(const Rights& rights, Need need) {
    switch (need) {
        case Need::kNothing:
            return true;
        case Need::kShown:
            return rights.may_read();
        case Need::kUse:
            return rights.may_command() || rights.control;
        case Need::kArrange:
            return rights.may_arrange();
        case Need::kRead:
            return rights.may_read() && rights.dashboard.empty();
        case Need::kCommand:
            return rights.may_command();
        case Need::kStop:
            return rights.may_stop();
        case Need::kResume:
            return rights.may_resume();
        case Need::kLabel:
            return rights.may_label();
        case Need::kRaw:
            return rights.may_send_raw();
        case Need::kLend:
            return rights.may_lend();
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

constexpr std::size_t kWorthCompressing = 1400;     // what fits into one packet gains nothing
constexpr std::size_t kMaxCompressed = 256 * 1024;  // more would take longer than a turn may

struct Served {
    std::string origin;
    bool gzip = false;
    std::function<Budget::Part()> part;  // of its client; empty: not known, and what it gets is short
};

constexpr std::size_t kShort = 4096;  // what is not counted

// What a client takes slowly is kept until it has: of one client not without bound.
void count(const Served& served, http::Response& response) {
    if (!served.part || response.body.size() <= kShort) return;
    auto part = std::make_shared<Budget::Part>(served.part());
    if (part->set(response.body.size())) {
        response.held = std::move(part);
        return;
    }
    response = problem(429, "too much waits to be read by this client (max-client-bytes): read it first");
}

http::Reply finished(const http::Reply& reply, Served served) {
    return reply.with([served = std::move(served)](http::Response& response) {
        const bool worth = !response.compressed && response.body.size() >= kWorthCompressing &&
                           response.body.size() <= kMaxCompressed;
        if (worth || response.status == 304) response.by_encoding = true;
        if (worth && served.gzip) {
            response.body = http::compress(response.body);
            response.compressed = true;
        }
        count(served, response);
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
            "Authorization, Content-Type, Idempotency-Key, If-Match, If-None-Match, Last-Event-ID, "
            "Asip-Session");
        response.headers.emplace_back("Access-Control-Max-Age", "600");
    }
    reply.send(std::move(response));
}

bool known_parameters(const http::Request& request, const http::Reply& reply, const Route& route) {
    std::set<std::string> seen;
    for (const auto& [name, value] : request.query) {
        const auto known = std::any_of(route.query.begin(), route.query.end(),
                                       [&](const Parameter& each) { return each.name == name; });
        std::string fault;
        if (!known) {
            std::vector<std::string_view> names;
            for (const auto& parameter : route.query)
                names.push_back(parameter.name);
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

constexpr const char* kLessonOver =
    "the lesson is over, or the teacher has taken this board over, or the gateway was started anew; type the "
    "code that the teacher shows";

void refuse_right(const Principal& principal, const http::Reply& reply, Need need) {
    if (!principal.rights.lesson.empty() && !principal.rights.may_read())
        return reply.send(problem(401, kLessonOver, {{"reason", "lesson-over"}}));
    if (!principal.rights.lesson.empty())
        return reply.send(problem(403,
                                  "a pupil commands its own board until the lesson ends; the teacher may "
                                  "resume, label, link and load boards"));
    if (!principal.rights.may_read()) {
        auto response = problem(401,
                                "a token is needed: Authorization: Bearer TOKEN; a browser signs in with it "
                                "at the page; asip-gateway token makes one");
        response.headers.emplace_back("WWW-Authenticate", "Bearer realm=\"asip\"");
        return reply.send(std::move(response));
    }
    if (!principal.rights.dashboard.empty())
        return reply.send(problem(
            403, "this link shows the dashboard " + principal.rights.dashboard + " and nothing else"));
    if (need == Need::kArrange && principal.rights.may_command())
        return reply.send(problem(403,
                                  "a token that is limited to some boards or services may not change "
                                  "dashboards, nor hold lessons"));
    if (need == Need::kLend && principal.rights.may_command())
        return reply.send(problem(403,
                                  "a token that is limited to some boards may lend one if lent-* is among "
                                  "them, and no services are named"));
    const std::string role(to_string(principal.rights.role));
    const bool whole_boards = need != Need::kNothing && need != Need::kRead && need != Need::kCommand;
    if (whole_boards && principal.rights.may_command() && !principal.rights.services.empty())
        return reply.send(
            problem(403, "a token that is limited to some services may do nothing to whole boards"));
    reply.send(problem(403, need == Need::kRaw
                                ? "a " + role + " without the right to raw lines may not do this"
                            : need == Need::kForget ? "only an admin may forget boards"
                                                    : "a " + role + " may only read"));
}

// Commands are logged with what became of them. What anybody may send at will leaves no line, and other
// changes of a client no more lines than it may send commands.
void log_change(const Call& call) {
    const auto& method = call.request.method;
    if (method != "POST" && method != "DELETE" && method != "PUT") return;
    const auto serve = call.route.serve;
    if (serve == post_command || serve == post_raw || serve == post_labels || serve == post_renew ||
        serve == post_action || serve == post_widget || serve == put_property || serve == put_board_values)
        return;
    if (call.route.need == Need::kNothing || call.route.need == Need::kRead) return;
    if (!call.gateway.log_rates().take(call.client(), call.now().time)) return;
    log::info("request", {{"by", call.principal.rights.name},
                          {"from", call.peer.address},
                          {"method", call.request.method},
                          {"target", text::printable(call.request.target, 200)}});
}

// The page's own addresses are relative to the folder in which it is.
bool redirect_to_folder(const Inner& inner, const http::Reply& reply) {
    const auto& request = inner.request;
    if (inner.prefix.empty() || !request.segments.empty() || request.folder) return false;
    const auto question = request.target.find('?');
    http::Response response;
    response.status = 308;
    response.content_type = "text/plain";
    response.headers = {
        {"Location",
         inner.prefix + "/" + (question == std::string::npos ? "" : request.target.substr(question))},
        {"Cache-Control", "no-store"}};
    reply.send(std::move(response));
    return true;
}

/// Whose request it is.
struct Asker {
    Principal principal;
    http::Peer peer;
    bool link = false;  ///< by a kiosk's link
};

void serve_route(Gateway& gateway, const http::Request& request, const http::Reply& reply, Asker asker) {
    auto& principal = asker.principal;
    std::string methods;
    const std::string_view method = request.method == "HEAD" ? "GET" : std::string_view(request.method);
    for (const auto& pattern : patterns()) {
        if (!fits(pattern, request.segments)) continue;
        const auto& route = *pattern.route;
        if (route.method != method) {
            methods += (methods.empty() ? "" : ", ") + std::string(route.method) +
                       (route.method == "GET" ? ", HEAD" : "");
            continue;
        }
        if (!allowed(principal.rights, route.need)) return refuse_right(principal, reply, route.need);
        if (!known_parameters(request, reply, route)) return;
        Call call{gateway,
                  request,
                  reply,
                  std::move(principal),
                  std::move(asker.peer),
                  route,
                  parameters_of(pattern, request.segments)};
        route.serve(call);
        return log_change(call);  // behind the answer: no client waits for the log
    }
    if (!methods.empty()) {
        methods += ", OPTIONS";
        if (method == "OPTIONS")
            return preflight(request, reply, methods, !gateway.gate().allowed_origin(request).empty());
        auto response = problem(405, "only " + methods);
        response.headers.emplace_back("Allow", methods);
        return reply.send(std::move(response));
    }
    const bool api =
        !request.segments.empty() && (request.segments[0] == "api" || request.segments[0] == "things");
    if (api) return reply.send(problem(404, "there is nothing at this address; see /api/openapi.json"));
    // The page's files are relative to their folder.
    if (request.folder && !request.segments.empty())
        return reply.send(problem(404, "there is nothing at this address"));
    serve_page(gateway, request, reply, asker.peer, asker.link ? &principal.rights : nullptr);
}

Expected<Principal, Denied> admit(Gateway& gateway, const http::Request& request,
                                  const std::optional<Inner>& inner) {
    const bool link = inner && inner->link;
    return link ? gateway.gate().admit_link(request, *inner->link, gateway.now())
                : gateway.gate().admit(request, gateway.now());
}

/// A stop that its asker may send.
bool stops(Gateway& gateway, const http::Request& request, const Rights& rights) {
    if (request.method != "POST" || !(rights.may_stop() || rights.control)) return false;
    for (const auto& pattern : patterns()) {
        if (pattern.route->method != request.method || !fits(pattern, request.segments)) continue;
        const auto serve = pattern.route->serve;
        if (serve != post_widget) return serve == post_stop || serve == post_stop_board;
        const auto path = parameters_of(pattern, request.segments);
        const auto* dashboard = gateway.dashboards().find(path.find("dashboard")->second);
        const auto* widget = dashboard == nullptr ? nullptr : dashboard->widget(path.find("widget")->second);
        return widget != nullptr && widget->kind == Widget::Kind::kStop;
    }
    return false;
}

}  // namespace

http::Asker asker_of(Gateway& gateway, const http::Request& received) {
    const auto& base = gateway.options().base_path;
    const auto inner = at_root(received, base) ? std::nullopt : inner_of(received, base);
    const auto& request = inner ? inner->request : received;
    const auto peer = gateway.gate().peer_of(request);
    const auto principal = admit(gateway, request, inner);
    if (!principal) return {"address " + http::network_of(peer.address)};
    return {client_of(*principal, peer), stops(gateway, request, principal->rights)};
}

void serve(Gateway& gateway, const http::Request& received, const http::Reply& plain) {
    const auto& base = gateway.options().base_path;
    const bool root = at_root(received, base);
    const auto inner = root ? std::nullopt : inner_of(received, base);
    if (!inner && !root) return plain.send(problem(404, "the gateway is at " + base + "/"));
    const auto& request = inner ? inner->request : received;
    Served served{gateway.gate().allowed_origin(request), http::accepts_gzip(request), {}};
    auto peer = gateway.gate().peer_of(request);
    const bool link = inner && inner->link;
    auto principal = admit(gateway, request, inner);
    if (principal) {
        served.part = [&gateway, client = client_of(*principal, peer)] {
            return gateway.budget().part(client);
        };
    }
    const auto reply = finished(plain, std::move(served));
    if (!principal) {
        auto response = problem(principal.error().status, principal.error().text);
        if (principal.error().status == 401)
            response.headers.emplace_back("WWW-Authenticate", "Bearer realm=\"asip\"");
        return reply.send(std::move(response));
    }
    if (request.is_asterisk())
        return preflight(request, reply, "GET, HEAD, POST, PUT, DELETE, OPTIONS", false);
    if (inner && redirect_to_folder(*inner, reply)) return;
    if (request.segments == std::vector<std::string>{""})
        return reply.send(problem(400, "the target of the request is no address"));
    serve_route(gateway, request, reply, {std::move(*principal), std::move(peer), link});
}

}  // namespace asip::gateway::api
