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

/// Clears retained topics that outlived their board. Pure.
/// - A ghost's lease ran out while its description stays retained (brokers without message expiry): if it is
/// still not alive a moment later, the description is cleared.
/// - A forgotten board's topics on the service bus are cleared at once; whatever else the broker retains
/// below its name follows, one topic after another.
/// A denied topic is not tried again for kDeniedTime: some MQTT libraries lose the connection over it.
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
    /// May come of a sweep.
    void retained(const std::string& topic, std::string_view board);
    void published(std::string_view topic);
    /// True: the tidier had published it, and it is the first one denied for kDeniedTime; to be reported.
    bool denied(const std::string& topic, Time now);
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
