// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "gateway/auth/logins.hpp"
#include "gateway/auth/tokens.hpp"
#include "gateway/http/message.hpp"
#include "gateway/instant.hpp"

namespace asip::gateway {

/// Who asks.
struct Principal {
    Rights rights;
    enum class Kind { kAnonymous, kLoopback, kToken, kSession } kind = Kind::kAnonymous;
};

/// Why a request is not served.
struct Denied {
    int status = 403;
    std::string text;
};

/// Decides who a request comes from and whether it may be served at all: before anything of it is looked at.
/// Pure.
class Gate {
  public:
    struct Options {
        std::vector<std::string> hosts;            ///< names that are ours, in lower case, without port
        std::vector<std::string> allowed_origins;  ///< of pages elsewhere that may call the API
        Rights loopback;   ///< of whoever connects over the loopback interface without a token
        Rights anonymous;  ///< of everybody else without a token
        std::string cookie = "asip";
        bool behind_proxy = false;  ///< TLS may end at the proxy: origins of either scheme are ours
    };

    Gate(Options options, Secrets secrets) : options_(std::move(options)), logins_(std::move(secrets)) {}

    void set_tokens(Tokens tokens) { tokens_ = std::move(tokens); }
    const Tokens& tokens() const { return tokens_; }
    Logins& logins() { return logins_; }
    const Options& options() const { return options_; }

    Expected<Principal, Denied> admit(const http::Request& request, const Instant& now) const;
    /// The same for what is below `/kiosk/TOKEN/`: the token of a kiosk, and nothing else that the request
    /// brings, decides what it may; it may read only.
    Expected<Principal, Denied> admit_link(const http::Request& request, std::string_view token,
                                           const Instant& now) const;
    /// Whether somebody admitted earlier still is: for open streams. A changed token ends them as well.
    bool still_admitted(const Principal& principal, const Instant& now) const;
    /// The value of our cookie; empty: none.
    std::string cookie_of(const http::Request& request) const;
    /// The origin of the request, if it is one that answers may be given to; empty: none.
    std::string allowed_origin(const http::Request& request) const;

  private:
    std::optional<Denied> wrong_host(const http::Request& request) const;
    std::optional<Denied> wrong_origin(const http::Request& request) const;
    Expected<Principal, Denied> who(const http::Request& request, const Instant& now) const;

    Options options_;
    Tokens tokens_;
    Logins logins_;
};

/// The host of a Host header or an origin, in lower case, without port and brackets.
std::string host_part(std::string_view authority);
/// Whether it is an IP address: names can be made to lead anywhere, addresses cannot.
bool is_ip_address(std::string_view host);

}  // namespace asip::gateway
