// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "asip/time.hpp"

namespace asip::session {

/// The state machine that looks for a board on a line whose rate may not be the one it was left at: asks
/// `#,?` at the start rate, then at each rate that boards step up to, round and round. On TCP there is only
/// one.
class Search {
  public:
    struct Step {
        unsigned baud = 0;  ///< to be at, 0: leave it
        bool ask = false;   ///< send the question; else only listen
        /// Ends a cut-off line; a 0.4 board may take it for a bad request, so not always.
        bool newline_first = false;
    };

    /// `quiet_until`: the board restarts; only listen until then.
    void start(unsigned start_baud, bool rates, Time quiet_until, Time now);
    Time next_deadline() const { return deadline_; }
    /// What to do now; call when the deadline has come.
    Step next(Time now);
    /// Something that reads as ASIP came: this rate is right, the next question is asked here again.
    void heard() { heard_ = true; }

  private:
    std::vector<unsigned> rates_;
    std::size_t index_ = 0;
    unsigned round_ = 0;
    bool heard_ = false;
    Time quiet_until_{};
    Time deadline_{};
};

}  // namespace asip::session
