// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <optional>
#include <set>
#include <string>

#include "asip/bus/request/requester.hpp"
#include "asip/bus/topics.hpp"
#include "asip/mqtt/client.hpp"
#include "tests/cluster/history.hpp"
#include "tests/support/catalogue_view.hpp"

namespace cluster {

/// Which boards are there; no other may be listed as online.
struct Truth {
    std::set<std::string> online;
};

/// Follows one registry over a connection of its own: asks for the whole catalogue several times a second,
/// and keeps a copy by its change events. Both must be the truth.
class Watcher {
  public:
    Watcher(boost::asio::io_context& io, asip::mqtt::Options options, std::string registry,
            const Truth& truth, History& history);

    void start();
    const std::string& registry() const { return registry_; }
    /// Since when what it saw was right; nothing while it is wrong or no answer comes.
    std::optional<Millis> right_since() const;
    /// What was seen so far counts no more.
    void look_anew() { right_since_.reset(); }
    const Difference& difference() const { return difference_; }
    /// What it saw, whenever that changed.
    const std::string& log() const { return log_; }

  private:
    void ask();
    void answered(const asip::bus::Answer& answer);
    void event(const asip::bus::ChangeEvent& event);
    void look(const std::vector<asip::bus::BoardItem>& boards);
    void note(std::string what);
    void compare(const std::map<std::string, std::string>& states, Difference& difference) const;

    std::string registry_;
    const Truth& truth_;
    History& history_;
    asip::bus::Topics topics_;
    asip::bus::Requester requester_;
    asip::mqtt::Client client_;
    boost::asio::steady_timer timer_;
    asip::bus::CatalogueView view_;
    asip::bus::Requester::Request request_;
    Millis asked_ = 0;
    std::string epoch_;
    std::uint64_t seq_ = 0;
    Millis came_ = 0;      // when the event with this number did
    bool joined_ = false;  // an event of this epoch has come over this connection
    Difference difference_;
    std::string noted_;
    std::string log_;
    std::optional<Millis> right_since_;
    Millis seen_ = 0;
};

}  // namespace cluster
