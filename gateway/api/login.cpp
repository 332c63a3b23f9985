// SPDX-License-Identifier: Apache-2.0
// `/?code=CODE`: a code becomes a cookie. A page of another site can lead a browser here with a code of its
// own, so that its user goes on as another user: none of another site is followed, and no session that is
// valid is replaced without a question.
#include "gateway/api/routes.hpp"

namespace asip::gateway::api {
namespace {

constexpr std::string_view kPolicy =
    "default-src 'none'; script-src 'self'; connect-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'";

http::Response html(int status, const std::string& body) {
    http::Response response;
    response.status = status;
    response.content_type = "text/html; charset=utf-8";
    response.headers = {{"Cache-Control", "no-store"}, {"Content-Security-Policy", std::string(kPolicy)}};
    response.body =
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" "
        "content=\"width=device-width\"><title>ASIP: sign in</title><script type=\"module\" "
        "src=\"login.js\"></script><main>" +
        body + "</main></html>";
    return response;
}

bool is_true(const http::Request& request, std::string_view name) {
    const auto* value = request.parameter(name);
    return value != nullptr && *value == "true";
}

/// How a request with a code came here.
enum class Way { kOtherSite, kOwnPage, kAddress, kUnknown };

/// Browsers say it (Sec-Fetch-Site) where the connection is encrypted, or goes to this machine. Else they
/// send a cookie that is SameSite=Strict only where one of our own pages leads: `mark` is such a one.
Way way_of(const http::Request& request, bool marked) {
    const auto site = request.header("sec-fetch-site");
    if (site == "cross-site" || site == "same-site") return Way::kOtherSite;
    if (site == "same-origin" || (site.empty() && marked)) return Way::kOwnPage;
    const bool browser = request.header("accept").find("text/html") != std::string_view::npos;
    return site.empty() && browser ? Way::kUnknown : Way::kAddress;
}

}  // namespace

std::string cookie_text(const Gateway& gateway, const std::string& name, const std::string& value,
                        std::string_view max_age_s, bool secure) {
    return name + "=" + value + "; Path=" + gateway.options().base_path +
           "/; HttpOnly; SameSite=Strict; Max-Age=" + std::string(max_age_s) + (secure ? "; Secure" : "");
}

void log_in(Gateway& gateway, const http::Request& request, const http::Peer& peer, const std::string& code,
            const http::Reply& reply) {
    auto& gate = gateway.gate();
    const auto now = gateway.now().time;
    const auto offered = gate.logins().offered(code, now);
    if (!offered)
        return reply.send(problem(401,
                                  "the code was used already or is older than 30 s; get another one with "
                                  "asipctl open, or sign in with a token"));
    const auto mark = gate.options().cookie + "-login";
    const auto way = way_of(request, gate.cookie_of(request, mark) == hash_of(code));
    if (way == Way::kOtherSite || (way == Way::kUnknown && is_true(request, "again")))
        return reply.send(problem(403,
                                  "a page of another site led here, or this browser keeps no cookies; if you "
                                  "want to sign in, enter this address yourself"));
    const auto here = "?code=" + code;
    if (way == Way::kUnknown) {
        auto response = html(200, "<p>Signing in. <a id=\"go\" data-at-once href=\"" + here +
                                      "&amp;again=true\">Go on</a></p>");
        response.headers.emplace_back("Set-Cookie",
                                      cookie_text(gateway, mark, hash_of(code), "60", peer.secure));
        return reply.send(std::move(response));
    }
    const auto present = gate.cookie_of(request);
    auto session = gate.logins().session(present, now);
    if (!session) session = gate.lessons(gateway.now()).rights_of(present, gateway.now());
    const bool other = session && session->name != offered->name;
    if (other && !(way == Way::kOwnPage && is_true(request, "replace"))) {
        // In the language of the browser by login.js.
        return reply.send(html(409, "<h1>Sign in as " + offered->name +
                                        "?</h1><p id=\"why\">This browser is signed in as " + session->name +
                                        ".</p><p><a id=\"stay\" href=\"./\" data-name=\"" + session->name +
                                        "\">Stay " + session->name + "</a></p><p><a id=\"go\" href=\"" +
                                        here + "&amp;replace=true\" data-name=\"" + offered->name +
                                        "\">Sign in as " + offered->name + "</a></p>"));
    }
    gate.lessons(gateway.now()).leave(present);
    const auto cookie = gate.logins().redeem(code, now);
    http::Response response;
    response.status = 303;
    response.content_type = "text/plain";
    response.headers = {{"Location", gateway.options().base_path + "/"},
                        {"Cache-Control", "no-store"},
                        {"Set-Cookie", cookie_text(gateway, gate.options().cookie, cookie.value_or(""),
                                                   "43200", peer.secure)}};
    reply.send(std::move(response));
}

}  // namespace asip::gateway::api
