#pragma once
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "asip/bus/topics.hpp"
#include "asip/time.hpp"
#include "registry/bus_port.hpp"

namespace asip::registry {

/// Empties retained topics that outlived their board. Two jobs:
///  - a ghost: a board whose lease ran out while its description stays retained (brokers without message
///  expiry); a
///    moment later, if it still is not alive, the description is emptied, so that nobody takes the board for
///    living;
///  - a forgotten board: its topics on the service bus are emptied at once; then the broker is asked for
///  whatever else
///    it retains below the board's name (last values, commands), and that is emptied, too.
class Tidier {
  public:
    static constexpr Duration kGhostDelay = std::chrono::seconds(2);
    static constexpr Duration kSweepTime = std::chrono::seconds(2);
    static constexpr std::size_t kSweepsAtOnce = 16;

    using IsAlive = std::function<bool(const std::string& board)>;

    Tidier(const bus::Topics& topics, BusPort bus, IsAlive is_alive);

    void ghost(std::string board, Time now);
    void forgotten(std::string board);
    /// A retained message that a sweep may have brought up.
    void retained(const std::string& topic, std::string_view board);
    /// Call a few times a second, while connected.
    void tick(Time now);

  private:
    void empty(std::string topic);
    std::string context_filter(const std::string& board) const;

    const bus::Topics& topics_;
    BusPort bus_;
    IsAlive is_alive_;
    std::deque<std::pair<Time, std::string>> ghosts_;
    std::deque<std::string> to_sweep_;
    std::map<std::string, Time, std::less<>> sweeping_;
};

}  // namespace asip::registry
