// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "asip/time.hpp"

namespace asip::registry {

/// Finds out when everything that the broker retains has arrived. A mark that the registry sends to itself is
/// delivered behind it, because it was subscribed to before. Pure.
class Settling {
  public:
    /// Where the mark is lost, the catalogue is taken for complete after this time.
    static constexpr Duration kLimit = std::chrono::seconds(15);

    /// `mark`: random, to be published to the registry's own query topic.
    void begin(std::string mark, Time now) {
        mark_ = std::move(mark);
        limit_ = now + kLimit;
    }
    bool active() const { return !mark_.empty(); }
    bool is_mark(std::string_view payload) const { return active() && payload == mark_; }
    bool overdue(Time now) const { return active() && now >= limit_; }
    void end() { mark_.clear(); }

  private:
    std::string mark_;
    Time limit_{};
};

}  // namespace asip::registry
