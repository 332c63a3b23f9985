// A request to its route: who may, which parameters, what every response carries.
#include <algorithm>
#include <set>

#include "asip/program/log.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"
#include "gateway/api/routes.hpp"

namespace asip::gateway::api {
namespace {

namespace log = program::log;

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
