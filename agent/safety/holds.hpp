// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/session/board_session.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// Commands that are in force only as long as whoever sent them renews them: dead man's switches. One for
/// each safe form (`M,s,0`: the element and how it is undone); a later command with the same safe form takes
/// the place of the earlier one, whoever sent it. Pure.
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
        std::string by{};  ///< who sent it; empty: not known
    };

    /// False: kMax others are held. To be asked before begin().
    bool room_for(std::string_view safe) const;
    /// The command was queued.
    void begin(Hold hold);
    /// Renews what `client` holds of the service, or only the command `id`; for `length`, or for as long as
    /// before, from `at` on: when the renewal came, at the earliest. Not from before the time before it. The
    /// number of holds renewed; 0: there is none any more.
    std::size_t renew(session::ClientId client, std::string_view service, std::optional<std::string_view> id,
                      std::optional<Duration> length, Time at);
    /// A request ended whose safe form is `safe`, or which is itself the safe form of others.
    void on_finished(const session::Finished& end, std::string_view safe);
    bool holds(std::string_view safe) const { return holds_.contains(safe); }

    /// Takes out those that were not renewed in time.
    std::vector<Hold> take_expired(Time now);
    /// Takes out all.
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
