// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "asip/bus/topics.hpp"
#include "asip/time.hpp"
#include "registry/port.hpp"

namespace asip::registry {

/// Clears retained topics that outlived their board:
///  - of a ghost: a board whose lease ran out while its description stays retained (brokers without message
///    expiry). If it still is not alive a moment later, its description is cleared, so that it is not taken
///    for alive;
///  - of a forgotten board: its topics on the service bus at once; then the broker is asked for whatever else
///    it retains below the board's name (last values, commands), and that is cleared, one topic after
///    another.
///
/// What the broker's access rules deny is not tried again for kDeniedTime: some MQTT libraries lose the
/// connection over it. Pure.
class Tidier {
  public:
    static constexpr Duration kGhostDelay = std::chrono::seconds(2);
    static constexpr Duration kSweepTime = std::chrono::seconds(2);
    static constexpr std::size_t kMaxSweeps = 16;  // at the same time
    static constexpr std::size_t kMaxToClear = 10'000;
    static constexpr Duration kClearTime = std::chrono::seconds(10);  // for one topic to be acknowledged
    static constexpr Duration kDeniedTime = std::chrono::hours(1);

    using IsAlive = std::function<bool(const std::string& board)>;

    Tidier(const bus::Topics& topics, Port port, IsAlive is_alive);

    void ghost(std::string board, Time now);
    void forgotten(std::string board);
    /// A retained message that a sweep may have brought up.
    void retained(const std::string& topic, std::string_view board);
    /// The broker accepted a message on this topic.
    void published(std::string_view topic);
    /// The broker denied a message on this topic. True: the tidier had published it, and it is the first one
    /// denied for kDeniedTime; to be reported.
    bool denied(const std::string& topic, Time now);
    /// Call a few times a second, while connected.
    void tick(Time now);

  private:
    void clear(std::string topic);
    void clear_next();
    void end_sweeps();
    bool may_sweep(Time now) const { return !denied_until_ || now >= *denied_until_; }
    std::string context_filter(const std::string& board) const;

    const bus::Topics& topics_;
    Port port_;
    IsAlive is_alive_;
    std::deque<std::pair<Time, std::string>> ghosts_;
    std::deque<std::string> to_sweep_;
    std::map<std::string, Time, std::less<>> sweeping_;
    std::deque<std::string> to_clear_;  // what sweeps brought up; the first one is under way
    std::optional<Time> clear_until_;
    std::set<std::string> denied_topics_;  // on the service bus, until denied_until_
    std::optional<Time> denied_until_;
};

}  // namespace asip::registry
