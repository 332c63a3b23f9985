// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "asip/mqtt/failure.hpp"
#include "asip/mqtt/options.hpp"

namespace asip::mqtt {

/// A broker that knows no MQTT 5: which version the next attempt at it speaks. Pure.
class VersionChoice {
  public:
    /// A broker that is just going down closes connections before it answers, too. So 3.1.1 is tried only
    /// after so many attempts in a row.
    static constexpr int kClosedUntil311 = 2;
    /// One that hangs does not answer, either. But an attempt that ends in silence takes seconds, and a
    /// broker that took MQTT 5 before is not suspected.
    static constexpr int kSilentUntil311 = 1;

    explicit VersionChoice(Version wanted) : wanted_(wanted) {}

    bool v5() const {
        return wanted_ == Version::kV5 ||
               (wanted_ == Version::kBest && !refused_v5_ && closed_with_v5_ < kClosedUntil311 &&
                silent_to_v5_ < kSilentUntil311);
    }
    void accepted() {
        took_v5_ = v5();
        closed_with_v5_ = silent_to_v5_ = 0;
    }
    /// An attempt failed. Where 3.1.1 fails in the same way the version was not the reason.
    void failed(const ConnectionEnd& end, bool tried_v5) {
        refused_v5_ = refused_v5_ || end.version_refused;
        closed_with_v5_ = end.closed_unanswered && tried_v5 ? closed_with_v5_ + 1 : 0;
        const bool silent = end.failure.kind == ConnectionFailure::Kind::kNoAnswer && !end.closed_unanswered;
        silent_to_v5_ = silent && tried_v5 && !took_v5_ ? silent_to_v5_ + 1 : 0;
    }
    /// Whether the same broker is to be tried again with another version. Silence may be a broker that hangs:
    /// the next one of the list is not kept waiting for it.
    bool suspected() const { return wanted_ == Version::kBest && closed_with_v5_ > 0; }

  private:
    Version wanted_;
    bool refused_v5_ = false;
    bool took_v5_ = false;
    int closed_with_v5_ = 0;  ///< in a row
    int silent_to_v5_ = 0;    ///< in a row
};

}  // namespace asip::mqtt
