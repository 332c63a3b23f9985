// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "asip/mqtt/client.hpp"
#include "bench/load/changes.hpp"
#include "bench/load/fleet.hpp"

namespace asip::load {

/// What all watchers together received.
struct WatchersTally {
    std::size_t watchers = 0;
    std::size_t listening = 0;  ///< at the end
    std::uint64_t connections_lost = 0, attempts_failed = 0;
    std::map<std::string, SeenChanges> registries{};
};

/// Programs that follow the changes of registries, each over a connection of its own, subscribed as
/// `asipctl events` is: to the events of all registries. They measure how fast a change reaches many
/// programs, and whether one of them misses an event. None keeps a catalogue: a thousand of them fit into one
/// process.
class Watchers {
  public:
    /// `fleet` and `io` must outlive it. `number`: how many watchers, above 0.
    Watchers(boost::asio::io_context& io, const mqtt::Options& options, const std::string& topic_root,
             std::size_t number, const Fleet& fleet);

    /// Connects them a few at a time, so that the broker is not flooded.
    void start();
    /// They disconnect; nothing is counted any more.
    void stop();
    WatchersTally tally() const;

  private:
    void schedule_start();
    mqtt::Client::Handlers handlers(std::size_t watcher);

    boost::asio::steady_timer start_timer_;
    std::string filter_;
    WatchersTally tally_;
    Changes changes_;
    std::vector<std::unique_ptr<mqtt::Client>> clients_;
    std::size_t started_ = 0;
};

}  // namespace asip::load
