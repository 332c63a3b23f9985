// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "asip/bus/request/demand.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// Demands of clients for values of this board. A demand counts kLinger longer than it lasts, so that a
/// client that comes back at once changes nothing. Where it is full, a user with fewer clients takes a place
/// of the user with most. Pure.
class Demands {
  public:
    static constexpr std::size_t kMax = 1024;
    static constexpr Duration kLinger = std::chrono::seconds(3);

    /// Replaces the demand of the same client, `demander` (USER/CLIENT); an empty one ends it. False: there
    /// is no room.
    bool take(std::string_view demander, bus::Demand demand, Time now);
    /// The rate in demand; 0: none is.
    double hz(std::string_view service, char letter) const;
    /// True: some ended.
    bool expire(Time now);
    std::optional<Time> next_deadline() const;
    std::size_t size() const { return entries_.size(); }

  private:
    struct Entry {
        std::map<std::string, double> services;
        Time until{};
    };
    using Entries = std::map<std::string, Entry, std::less<>>;  // by demander

    bool make_room(const std::string& user);
    void erase(Entries::iterator entry);

    Entries entries_;
    std::map<std::string, std::size_t> users_;  // -> their demanders
    Time earliest_ = Time::max();               // no entry ends before
};

}  // namespace asip::agent
