// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "asip/time.hpp"
#include "gateway/auth/rights.hpp"
#include "gateway/auth/secret.hpp"

namespace asip::gateway {

/// One-time codes that turn into cookies. Pure: time and randomness are passed in; secrets are kept as
/// hashes. Limits are of each name, so that no name uses up the places of others: there are as many names as
/// tokens, and two more ("loopback", "anonymous").
class Logins {
  public:
    static constexpr Duration kCodeTime = std::chrono::seconds(30);
    static constexpr Duration kSessionTime = std::chrono::hours(12);
    static constexpr std::size_t kMaxCodes = 20;      ///< of a name, open at once
    static constexpr std::size_t kMaxSessions = 100;  ///< of a name; one more ends the oldest

    explicit Logins(Secrets secrets) : secrets_(std::move(secrets)) {}

    /// A code that works once, within kCodeTime; empty: too many of this name are open.
    std::string make_code(const Rights& rights, Time now);
    /// Whom a code logs in; it can still be redeemed. Nothing for one that is not known, used or too old.
    std::optional<Rights> offered(std::string_view code, Time now) const;
    /// The cookie's value. A code works once; nothing for one that is not known, used or too old.
    std::optional<std::string> redeem(std::string_view code, Time now);
    /// The rights as they were when the code was made; nothing for a cookie that is not known or too old.
    std::optional<Rights> session(std::string_view cookie, Time now) const;
    /// Log out: the cookie is worth nothing from now on. One that is not known is passed over.
    void end(std::string_view cookie);
    /// Ends the codes and sessions whose rights are not in force any more.
    void end_unless(const std::function<bool(const Rights&)>& in_force);
    /// Forgets what is too old. Call now and then: what is too old works no more in any case.
    void expire(Time now);
    std::size_t sessions() const { return sessions_.size(); }

  private:
    struct Entry {
        Rights rights;
        Time until;
    };
    void end_oldest(const std::string& name);

    Secrets secrets_;
    std::map<std::string, Entry, std::less<>> codes_;  // by hash
    std::map<std::string, Entry, std::less<>> sessions_;
};

}  // namespace asip::gateway
