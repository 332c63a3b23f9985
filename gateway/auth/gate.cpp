// SPDX-License-Identifier: Apache-2.0
#include "gateway/auth/gate.hpp"

#include <algorithm>
#include <string_view>

#include "asip/text/printable.hpp"
#include "gateway/auth/secret.hpp"
#include "gateway/http/address.hpp"

namespace asip::gateway {

namespace {

using http::is_ip_address;
using http::lower;

bool is_websocket(const http::Request& request) {
    return lower(request.header("upgrade")) == "websocket";
}

bool is_safe(const http::Request& request) {
    return request.method == "GET" || request.method == "HEAD" || request.method == "OPTIONS";
}

bool is_json(std::string_view content_type) {
    const auto type = lower(content_type.substr(0, content_type.find(';')));
    return type.substr(0, type.find_last_not_of(' ') + 1) == "application/json";
}

/// The token of `Authorization: Bearer TOKEN`, or of a WebSocket's offered protocol `asip.bearer.TOKEN`:
/// browsers let a page set no other header there.
std::optional<std::string> bearer(const http::Request& request) {
    const auto header = request.header("authorization");
    if (header.size() > 7 && lower(header.substr(0, 7)) == "bearer ") return std::string(header.substr(7));
    if (!header.empty()) return std::string();
    if (!is_websocket(request)) return std::nullopt;
    constexpr std::string_view kPrefix = "asip.bearer.";
    const auto offered = request.header("sec-websocket-protocol");
    const auto at = offered.find(kPrefix);
    if (at == std::string_view::npos) return std::nullopt;
    const auto rest = offered.substr(at + kPrefix.size());
    return std::string(rest.substr(0, rest.find_first_of(", ")));
}

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t");
    if (first == text.npos) return {};
    return text.substr(first, text.find_last_not_of(" \t") + 1 - first);
}

std::string_view last_element(const http::Request& request, std::string_view name) {
    std::string_view last;
    for (const auto& [key, value] : request.headers)
        if (key == name) last = value;
    return trimmed(last.substr(last.rfind(',') + 1));
}

/// `for=192.0.2.1;proto=https` -> the value of a member, without quotes.
std::string_view member(std::string_view element, std::string_view name) {
    for (;;) {
        const auto end = std::min(element.find(';'), element.size());
        const auto pair = trimmed(element.substr(0, end));
        const auto equals = std::min(pair.find('='), pair.size());
        if (http::lower(pair.substr(0, equals)) == name && equals < pair.size()) {
            auto value = pair.substr(equals + 1);
            if (value.size() >= 2 && value.front() == '"' && value.back() == '"')
                value = value.substr(1, value.size() - 2);
            return value;
        }
        if (end == element.size()) return {};
        element.remove_prefix(end + 1);
    }
}

/// "192.0.2.1:4711", "[2001:db8::1]:4711" or an address alone; empty: it is none.
std::string address_in(std::string_view text) {
    if (text.starts_with('['))
        text = text.substr(1, std::min(text.find(']'), text.size()) - 1);
    else if (std::count(text.begin(), text.end(), ':') == 1)
        text = text.substr(0, text.find(':'));
    return http::is_ip_address(text) ? std::string(text) : std::string();
}

}  // namespace

http::Peer Gate::peer_of(const http::Request& request) const {
    auto peer = request.peer;
    const bool from_proxy = peer.loopback || peer.address.empty();  // a Unix socket has no address
    if (!options_.behind_proxy || !from_proxy) return peer;
    auto forwarded = forwarded_by(request);
    if (!forwarded.address.empty()) peer.address = std::move(forwarded.address);
    peer.secure = peer.secure || forwarded.secure;
    return peer;
}

std::string client_of(const Principal& principal, const http::Peer& peer) {
    using Kind = Principal::Kind;
    const bool named = principal.kind == Kind::kToken || principal.kind == Kind::kSession;
    return named ? principal.rights.name : "address " + http::network_of(peer.address);
}

std::string host_part(std::string_view authority) {
    const bool bracketed = authority.starts_with('[');
    const auto end = bracketed ? authority.find(']') : std::min(authority.find(':'), authority.size());
    if (end == std::string_view::npos) return {};
    const auto host = bracketed ? authority.substr(1, end - 1) : authority.substr(0, end);
    const auto rest = authority.substr(bracketed ? end + 1 : end);
    const bool port =
        rest.empty() || (rest.front() == ':' && rest.find_first_not_of("0123456789", 1) == rest.npos);
    const bool address = !bracketed || (is_ip_address(host) && host.find(':') != host.npos);
    return port && address ? lower(host) : std::string();
}

std::optional<Denied> Gate::wrong_host(const http::Request& request) const {
    const auto host = host_part(request.header("host"));
    if (!request.has_header("host") && request.http_1_0) return std::nullopt;
    if (host.empty()) return Denied{400, "the request has no Host of the form NAME:PORT"};
    if (!request.scheme.empty() && (request.scheme == "https") != request.peer.secure &&
        !options_.behind_proxy)
        return Denied{421, "this connection is not " + request.scheme};
    const auto& ours = options_.hosts;
    if (is_ip_address(host) || std::find(ours.begin(), ours.end(), host) != ours.end()) return std::nullopt;
    return Denied{421, "\"" + text::printable(host) + "\" is not a name of this gateway; --host adds one"};
}

std::string Gate::allowed_origin(const http::Request& request) const {
    const auto origin = request.header("origin");
    const auto& allowed = options_.allowed_origins;
    return std::find(allowed.begin(), allowed.end(), origin) == allowed.end() ? std::string()
                                                                              : std::string(origin);
}

// What a page of another origin makes a browser send is refused, whatever cookie or address it comes with.
std::optional<Denied> Gate::wrong_origin(const http::Request& request) const {
    if (is_safe(request) && !is_websocket(request)) return std::nullopt;
    if (!allowed_origin(request).empty()) return std::nullopt;
    if (const auto site = request.header("sec-fetch-site"); site == "cross-site" || site == "same-site")
        return Denied{403, "a page of another site may not do this; --allow-origin lets one"};
    if (!request.has_header("origin")) return std::nullopt;
    const auto origin = lower(request.header("origin"));
    const auto authority = lower(request.header("host"));
    const bool http = origin == "http://" + authority;
    const bool https = origin == "https://" + authority;
    if (request.peer.secure ? https : http || (options_.behind_proxy && https)) return std::nullopt;
    return Denied{403, "a page of " + text::printable(origin) + " may not do this; --allow-origin lets one"};
}

std::string Gate::cookie_of(const http::Request& request, std::string_view name) {
    std::string_view rest = request.header("cookie");
    while (!rest.empty()) {
        const auto end = rest.find(';');
        auto pair = rest.substr(0, end);
        rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
        while (!pair.empty() && pair.front() == ' ')
            pair.remove_prefix(1);
        if (pair.starts_with(name) && pair.substr(name.size()).starts_with('='))
            return std::string(pair.substr(name.size() + 1));
    }
    return {};
}

// The rights of a token of the file, or of a dashboard's link. A link gives none once its dashboard is
// removed.
Expected<Rights, Denied> Gate::rights_of(std::string_view token, const Instant& now, int status,
                                         const char* fault) const {
    const auto* named = tokens_.find(token);
    std::optional<Rights> rights;
    if (named != nullptr) rights = *named;
    if (!rights && shared_.link && !token.empty()) rights = shared_.link(hash_of(token));
    const bool over = !rights || (rights->until && *rights->until <= now.wall) ||
                      (rights->of_link() && !maker_in_force(*rights, now)) ||
                      (!rights->dashboard.empty() && shared_.there && !shared_.there(rights->dashboard));
    if (!over) return std::move(*rights);
    // It may be a link of a dashboard that was not heard of yet.
    if (!rights && shared_.known && !shared_.known())
        return Unexpected<Denied>(
            Denied{503, "what the broker retains is still being read; try again in a moment"});
    return Unexpected<Denied>(Denied{status, fault});
}

Expected<Principal, Denied> Gate::who(const http::Request& request, const Instant& now) const {
    if (const auto token = bearer(request)) {
        auto rights = rights_of(*token, now, 401, "the token is not known, or has expired");
        if (!rights) return Unexpected<Denied>(std::move(rights.error()));
        return Principal{std::move(*rights), Principal::Kind::kToken};
    }
    if (const auto cookie = cookie_of(request); !cookie.empty()) {
        if (Lessons::is_cookie(cookie)) return pupil(cookie, now);
        if (auto rights = logins_.session(cookie, now.time)) {
            Principal principal{std::move(*rights), Principal::Kind::kSession, cookie};
            if (still_admitted(principal, now)) return principal;
        }
    }
    if (request.peer.loopback && options_.loopback.role != Role::kNone && came_through_proxy(request))
        return Unexpected<Denied>(
            Denied{403,
                   "this request came through a proxy on this machine, and asip-gateway was not told of one: "
                   "every client of the proxy would have the rights of this machine; start it with "
                   "--trusted-proxy"});
    if (request.peer.loopback && options_.loopback.role != Role::kNone)
        return Principal{options_.loopback, Principal::Kind::kLoopback};
    return Principal{options_.anonymous, Principal::Kind::kAnonymous};
}

// The lesson of a browser that was in one may be over: then it has no rights at all, not those of its
// address, until it leaves.
Principal Gate::pupil(const std::string& cookie, const Instant& now) const {
    if (auto rights = lessons_.rights_of(cookie, now)) {
        Principal principal{std::move(*rights), Principal::Kind::kSession, cookie};
        if (still_admitted(principal, now)) return principal;
    }
    Principal over;
    over.rights.lesson = "over";
    return over;
}

Lessons& Gate::lessons(const Instant& now) {
    lessons_.expire(now, [&](const Rights& pupil) { return maker_in_force(pupil, now); });
    return lessons_;
}

Expected<Principal, Denied> Gate::admit(const http::Request& request, const Instant& now) const {
    if (auto denied = wrong_host(request)) return Unexpected<Denied>(std::move(*denied));
    if (auto denied = wrong_origin(request)) return Unexpected<Denied>(std::move(*denied));
    const bool changes = !is_safe(request) && request.method != "DELETE";
    if (changes && !is_json(request.header("content-type")))
        return Unexpected<Denied>(Denied{415, "send Content-Type: application/json"});
    return who(request, now);
}

Expected<Principal, Denied> Gate::admit_link(const http::Request& request, std::string_view token,
                                             const Instant& now) const {
    if (auto denied = wrong_host(request)) return Unexpected<Denied>(std::move(*denied));
    if (auto denied = wrong_origin(request)) return Unexpected<Denied>(std::move(*denied));
    constexpr const char* kNotValid = "this link is not valid, or not any more";
    auto rights = rights_of(token, now, 404, kNotValid);
    if (!rights) return Unexpected<Denied>(std::move(rights.error()));
    if (rights->role != Role::kKiosk) return Unexpected<Denied>(Denied{404, kNotValid});
    const bool uses_controls = rights->control && request.method == "POST";
    if (!is_safe(request) && !uses_controls)
        return Unexpected<Denied>(Denied{403, "a kiosk's link may only read"});
    if (uses_controls && !is_json(request.header("content-type")))
        return Unexpected<Denied>(Denied{415, "send Content-Type: application/json"});
    return Principal{std::move(*rights), Principal::Kind::kToken};
}

bool Gate::still_admitted(const Principal& principal, const Instant& now) const {
    const auto& rights = principal.rights;
    if (rights.until && *rights.until <= now.wall) return false;
    if (!rights.lesson.empty())
        return lessons_.rights_of(principal.cookie, now) == rights && maker_in_force(rights, now);
    if (!rights.dashboard.empty() && shared_.there && !shared_.there(rights.dashboard)) return false;
    if (rights.of_link()) return shared_.holds && shared_.holds(rights) && maker_in_force(rights, now);
    if (principal.kind == Principal::Kind::kAnonymous || principal.kind == Principal::Kind::kLoopback)
        return true;
    if (principal.kind == Principal::Kind::kSession && !logins_.session(principal.cookie, now.time))
        return false;
    return in_force(rights);
}

bool Gate::in_force(const Rights& rights) const {
    if (rights.token_hash.empty()) {
        const auto& own = rights.name == options_.loopback.name ? options_.loopback : options_.anonymous;
        return rights.name == own.name && own.role != Role::kNone;
    }
    const auto* token = tokens_.named(rights.name);
    return token != nullptr && *token == rights;
}

// A link gives rights of its maker: it ends with them.
bool Gate::maker_in_force(const Rights& link, const Instant& now) const {
    if (const auto* token = tokens_.named(link.maker); token != nullptr)
        return token->may_arrange() && !(token->until && *token->until <= now.wall) &&
               (link.maker_mark.empty() || link.maker_mark == token->mark());
    for (const auto* own : {&options_.loopback, &options_.anonymous})
        if (own->name == link.maker && link.maker_mark.empty()) return own->may_arrange();
    return false;
}

void Gate::set_tokens(Tokens tokens) {
    tokens_ = std::move(tokens);
    logins_.end_unless([this](const Rights& rights) { return in_force(rights); });
}

bool came_through_proxy(const http::Request& request) {
    return std::any_of(request.headers.begin(), request.headers.end(), [](const auto& header) {
        const std::string_view name = header.first;
        return name == "forwarded" || name.starts_with("x-forwarded-") || name == "x-real-ip" ||
               name == "via";
    });
}

Forwarded forwarded_by(const http::Request& request) {
    const auto standard = last_element(request, "forwarded");
    Forwarded result;
    result.address = address_in(last_element(request, "x-forwarded-for"));
    if (result.address.empty()) result.address = address_in(member(standard, "for"));
    auto scheme = last_element(request, "x-forwarded-proto");
    if (scheme.empty()) scheme = member(standard, "proto");
    result.secure = http::lower(scheme) == "https";
    return result;
}

}  // namespace asip::gateway
