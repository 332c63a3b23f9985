#pragma once
#include <map>
#include <set>
#include <string>

#include "asip/bus/topics.hpp"
#include "asip/time.hpp"
#include "registry/bus_port.hpp"

namespace asip::registry {

/// Listens to the context traffic of boards that take part by names only, because it renews their leases.
/// Boards that also have a description say both within a moment, so a subscription waits that moment. Beyond
/// kMost such boards, it listens to all boards instead.
class TrafficListener {
  public:
    static constexpr Duration kDelay = std::chrono::seconds(1);
    static constexpr std::size_t kMost = 2000;

    TrafficListener(const bus::Topics& topics, BusPort bus);

    void listen(const std::string& board, Time now);
    void unlisten(const std::string& board);
    void tick(Time now);

  private:
    const bus::Topics& topics_;
    BusPort bus_;
    std::map<std::string, Time> waiting_;
    std::set<std::string> listening_;
    bool to_all_ = false;
};

}  // namespace asip::registry
