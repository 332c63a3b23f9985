// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/session/board_session.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// Commands that are in force only while their sender renews them, as a dead man's switch. There is one hold
/// for each safe form (`M,s,0`): a later command with the same form replaces it, whoever sent it. Pure: the
/// caller sends the safe forms of take_expired() and take_all().
class Holds {
  public:
    static constexpr std::size_t kMax = 64;

    struct Hold {
        session::ClientId client = 0;
        std::string id;       ///< of the command; empty: it had none
        std::string service;  ///< its name on the board
        std::string line;     ///< the request
        std::string safe;     ///< the request that undoes it
        Duration length{};
        Time ends{};
        session::RequestId request = 0;
        std::string by{};  ///< its sender; empty: not known
    };

    /// False: there are kMax other holds. Ask before begin().
    bool room_for(std::string_view safe) const;
    void begin(Hold hold);
    /// Renews the holds of `client` at the service, or that of the command `id`, for `length` or as long as
    /// before. The time counts from `at`, the earliest moment of sending, but not from before the last
    /// renewal. Returns how many holds were renewed.
    std::size_t renew(session::ClientId client, std::string_view service, std::optional<std::string_view> id,
                      std::optional<Duration> length, Time at);
    /// `safe`: the safe form of the request that ended.
    void on_finished(const session::Finished& end, std::string_view safe);
    bool holds(std::string_view safe) const { return holds_.contains(safe); }

    /// Takes out the holds that were not renewed in time.
    std::vector<Hold> take_expired(Time now);
    std::vector<Hold> take_all();
    std::optional<Time> next_deadline() const;
    std::size_t size() const { return holds_.size(); }

  private:
    struct Entry {
        Hold hold;
        bool in_force = false;      // the board executed it
        bool maybe_before = false;  // what it took the place of may be in force
    };
    std::map<std::string, Entry, std::less<>> holds_;  // by safe form
};

}  // namespace asip::agent
