// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "asip/mqtt/failure.hpp"
#include "asip/mqtt/options.hpp"

namespace asip::mqtt {

/// Brokers that know no MQTT 5: the version of the next attempt. Pure.
class VersionChoice {
  public:
    /// A broker that goes down closes connections unanswered, too: 3.1.1 is tried after so many in a row.
    static constexpr int kClosedUntil311 = 2;
    /// A hanging broker is silent, too. But such attempts take seconds, and a broker that took MQTT 5 before
    /// is not suspected.
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
    /// Where 3.1.1 fails in the same way the version was not the reason.
    void failed(const ConnectionEnd& end, bool tried_v5) {
        refused_v5_ = refused_v5_ || end.version_refused;
        closed_with_v5_ = end.closed_unanswered && tried_v5 ? closed_with_v5_ + 1 : 0;
        const bool silent = end.failure.kind == ConnectionFailure::Kind::kNoAnswer && !end.closed_unanswered;
        silent_to_v5_ = silent && tried_v5 && !took_v5_ ? silent_to_v5_ + 1 : 0;
    }
    /// Try the same broker with another version. After silence the next one of the list goes first: the
    /// broker may hang.
    bool suspected() const { return wanted_ == Version::kBest && closed_with_v5_ > 0; }

  private:
    Version wanted_;
    bool refused_v5_ = false;
    bool took_v5_ = false;
    int closed_with_v5_ = 0;  ///< in a row
    int silent_to_v5_ = 0;    ///< in a row
};

}  // namespace asip::mqtt
