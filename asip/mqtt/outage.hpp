// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <set>
#include <string>
#include <utility>

#include "asip/mqtt/client.hpp"

namespace asip::mqtt {

/// Decides which failures of one outage are worth a line in the log. Attempts repeat every few seconds, and
/// fail in the same way each time.
class Outage {
  public:
    /// Whether this broker has not yet failed in this way since over().
    bool is_news(const ConnectionFailure& failure) {
        return seen_.emplace(failure.broker.describe(), failure.kind).second;
    }
    /// Call when a connection is established.
    void over() { seen_.clear(); }

  private:
    std::set<std::pair<std::string, ConnectionFailure::Kind>> seen_;
};

}  // namespace asip::mqtt
