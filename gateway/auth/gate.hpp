// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "gateway/auth/lessons.hpp"
#include "gateway/auth/logins.hpp"
#include "gateway/auth/tokens.hpp"
#include "gateway/http/message.hpp"
#include "gateway/instant.hpp"

namespace asip::gateway {

/// The client that asks: what it may do, and by what that is known.
struct Principal {
    Rights rights;
    enum class Kind { kAnonymous, kLoopback, kToken, kSession } kind = Kind::kAnonymous;
    std::string cookie{};  ///< kSession: of the browser; the session may end before the rights do
};

/// Why a request is not served: an HTTP status and a sentence for a person, that says what to do.
struct Denied {
    int status = 403;
    std::string text;
};

/// Decides which client a request comes from and whether it may be served at all: before anything of it is
/// looked at. Whether the client may use its route is the API's to say (Need). Pure: time is passed in.
class Gate {
  public:
    struct Options {
        std::vector<std::string> hosts;            ///< names that are ours, in lower case, without port
        std::vector<std::string> allowed_origins;  ///< of pages elsewhere that may call the API
        Rights loopback;   ///< of a client that connects over the loopback interface without a token
        Rights anonymous;  ///< of every other client without a token
        std::string cookie = "asip";
        /// Connections from this machine are a proxy's: X-Forwarded-For names its clients, no client is
        /// "this machine", and TLS may end at the proxy, so origins of either scheme are ours.
        bool behind_proxy = false;
    };

    Gate(Options options, const Secrets& secrets)
        : options_(std::move(options)), logins_(secrets), lessons_(secrets) {}

    /// What the gate is told of dashboards, whose links are kept with them.
    struct Shared {
        /// What a link allows, by the hash of its token.
        std::function<std::optional<Rights>(std::string_view hash)> link;
        /// Whether the link that gave these rights still does.
        std::function<bool(const Rights& rights)> holds;
        /// Whether there may be such a dashboard: also while that is not known yet.
        std::function<bool(const std::string& dashboard)> there;
        std::function<bool()> known;  ///< all of them have been read
    };
    void set_shared(Shared shared) { shared_ = std::move(shared); }

    /// In place of those of before; log-ins by tokens that are gone or changed end. Ask still_admitted() of
    /// each client that was admitted by them.
    void set_tokens(Tokens tokens);
    const Tokens& tokens() const { return tokens_; }
    Logins& logins() { return logins_; }
    /// Those that are going on: each ends with the rights of its teacher.
    Lessons& lessons(const Instant& now);
    const Options& options() const { return options_; }

    /// The other end of a request: behind a proxy its client, by the last element of
    /// X-Forwarded-For (else of Forwarded) and X-Forwarded-Proto, which the proxy itself wrote. A client that
    /// comes past the proxy is not believed.
    http::Peer peer_of(const http::Request& request) const;
    /// By, in this order: a token (one that is not known is refused, whatever else there is), a cookie (one
    /// that is not known is as none, one of a lesson that is over gives no rights), being on this machine,
    /// and being anybody. 421: another host's request; 403: a page of another site, or a proxy that the
    /// gateway was not told of; 415: a change that is not JSON; 401.
    Expected<Principal, Denied> admit(const http::Request& request, const Instant& now) const;
    /// The same for what is below `/kiosk/TOKEN/`: the token of a kiosk, and nothing else that the request
    /// brings, decides what it may; it may read only, unless it may use the controls of its dashboard.
    Expected<Principal, Denied> admit_link(const http::Request& request, std::string_view token,
                                           const Instant& now) const;
    /// Whether a client admitted earlier still is: for open streams. A token that was changed or replaced
    /// ends them, and so does the end of the session.
    bool still_admitted(const Principal& principal, const Instant& now) const;
    /// The value of our cookie; empty: none.
    std::string cookie_of(const http::Request& request) const { return cookie_of(request, options_.cookie); }
    /// The value of any cookie, by its name.
    static std::string cookie_of(const http::Request& request, std::string_view name);
    /// The origin of the request, if it is one that answers may be given to; empty: none.
    std::string allowed_origin(const http::Request& request) const;

  private:
    std::optional<Denied> wrong_host(const http::Request& request) const;
    std::optional<Denied> wrong_origin(const http::Request& request) const;
    Expected<Principal, Denied> who(const http::Request& request, const Instant& now) const;
    bool in_force(const Rights& rights) const;
    Principal pupil(const std::string& cookie, const Instant& now) const;
    bool maker_in_force(const Rights& link, const Instant& now) const;

    Expected<Rights, Denied> rights_of(std::string_view token, const Instant& now, int status,
                                       const char* fault) const;

    Options options_;
    Shared shared_;
    Tokens tokens_;
    Logins logins_;
    Lessons lessons_;
};

/// The host of a Host header, in lower case, without port and brackets; empty: it is no HOST[:PORT].
std::string host_part(std::string_view authority);
/// Whom limits count: the name of the token, else the address.
std::string client_of(const Principal& principal, const http::Peer& peer);

/// Whether a request has a header that only proxies write: Forwarded, X-Forwarded-..., X-Real-IP or Via.
bool came_through_proxy(const http::Request& request);

/// What the proxy nearest to us says of its client.
struct Forwarded {
    std::string address;  ///< an IP address; empty: it says none
    bool secure = false;  ///< the client speaks TLS to it
};
/// The last element of X-Forwarded-For and X-Forwarded-Proto, else of Forwarded (RFC 7239), counts: that the
/// proxy wrote itself; those before it may be anybody's. Only for requests that do come from a proxy.
Forwarded forwarded_by(const http::Request& request);

}  // namespace asip::gateway
