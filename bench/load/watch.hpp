// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "asip/bus/registry/answer.hpp"
#include "bench/load/calling.hpp"
#include "bench/load/changes.hpp"
#include "bench/load/fleet.hpp"

namespace asip::load {

/// What one registry said of the simulated boards.
struct Watched {
    std::uint64_t events = 0;
    EventNumbers numbers{};
    Times online;  ///< from a board's description to the event, as this program saw both
    Times lost;    ///< from a broken connection to the event
    /// By the last comparison of its catalogue with the truth.
    std::size_t listed = 0;
    std::size_t wrong = 0;
    std::vector<std::string> examples;  ///< of what is wrong, in words
    std::optional<Duration> agreed{};   ///< after so long nothing was wrong
};

/// When what an event tells happened to a board of ours: it was announced, or its connection broke. Nothing:
/// it is another change, or the board's state is another one by now.
std::optional<Time> happened(const Fleet& fleet, const bus::ChangeEvent& event);

/// A watcher of all registries, over a connection of its own. It times their events, and at the end of a run
/// it compares their catalogues with what the fleet knows to be true.
class Watch {
  public:
    /// `fleet` and `io` must outlive it. `prefix`: of the names of our boards; boards of others are ignored.
    Watch(boost::asio::io_context& io, mqtt::Options options, const std::string& topic_root,
          const std::string& prefix, const Fleet& fleet);

    /// Connects. Events that came before are not known.
    void start() { bus_.client.start(); }
    /// Asks each registry that lives for its catalogue, again and again until it agrees with the truth; calls
    /// `done` when all do, or after `limit`.
    void compare(Duration limit, std::function<void()> done);

    /// By their ids. A registry is in it from its first event, or from the first comparison on.
    const std::map<std::string, Watched>& registries() const { return registries_; }

  private:
    /// One pass through the catalogue of a registry, page by page.
    struct Comparison {
        std::size_t right = 0, listed = 0, wrong = 0;
        std::vector<std::string> examples{};
        caller::Caller::Question request{};
    };

    void received(const mqtt::Message& message);
    void event(const bus::ChangeEvent& event);
    void ask(const std::string& registry, const std::string& cursor);
    void page(const std::string& registry, const bus::Answer& answer);
    void compared(const std::string& registry);
    void compare_again(const std::string& registry);
    void finish();

    const Fleet& fleet_;
    bus::Topics topics_;
    std::string prefix_;
    Calling bus_;
    std::map<std::string, Watched> registries_;
    std::map<std::string, bool> living_;
    std::map<std::string, Comparison> comparisons_;
    Time compared_since_{};
    boost::asio::steady_timer limit_;
    boost::asio::steady_timer again_;
    std::function<void()> done_;
};

}  // namespace asip::load
