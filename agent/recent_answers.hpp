#pragma once
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <unordered_map>

#include "asip/bus/reply.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// Remembers requests by their key for a minute, so that a repeated one is answered again instead of executed
/// again. At most kMost; beyond, the oldest is forgotten.
class RecentAnswers {
  public:
    static constexpr std::size_t kMost = 4096;
    static constexpr Duration kKept = std::chrono::minutes(1);

    enum class Seen { kNew, kPending, kAnswered };

    /// Whether a request with this key was seen before; a new one is remembered as pending.
    Seen see(const std::string& key, Time now);
    void answer(const std::string& key, bus::Reply reply);
    /// The reply of an answered one.
    const bus::Reply* find(const std::string& key) const;
    std::size_t size() const { return entries_.size(); }

  private:
    void forget_old(Time now);

    std::unordered_map<std::string, std::optional<bus::Reply>> entries_;
    std::deque<std::pair<Time, std::string>> order_;
};

}  // namespace asip::agent
