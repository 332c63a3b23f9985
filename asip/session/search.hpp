// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "asip/time.hpp"

namespace asip::session {

/// The state machine that looks for a board on a line whose rate may not be the one it was left at: asks
/// `#,?` at the start rate, then at each rate that boards step up to, in cycles. A cycle in which
/// bytes came, but none that read as ASIP, is followed by a longer one: a board on a busy machine may answer
/// later than its rate has its turn. On TCP there is only one rate. Now and then more than a second passes
/// without a question: a 0.4 board that waits inside a cut-off message goes on only then.
class Search {
  public:
    struct Step {
        unsigned baud = 0;  ///< to be at, 0: leave it
        bool ask = false;   ///< send the question; else only listen
        /// Ends a cut-off line; a 0.4 board may take it for a bad request, so not always.
        bool newline_first = false;
    };

    /// `quiet_until`: the board restarts; only listen until then. `turn`: that of a search whose board turned
    /// out to be none at that rate, else 1.
    void start(unsigned start_baud, bool rates, int turn, Time quiet_until, Time now);
    /// How many times as long as at first each rate has its turn now: 1, 2 or 4.
    int turn() const { return turn_; }
    static int longer(int turn);
    Time next_deadline() const { return deadline_; }
    /// What to do now; call when the deadline has come.
    Step next(Time now);
    /// Something that reads as ASIP came: this rate is right, the next question is asked here again.
    void heard() { heard_ = true; }
    /// Bytes came, of whatever kind.
    void bytes_came() { bytes_came_ = true; }

  private:
    std::vector<unsigned> rates_;
    std::size_t index_ = 0;
    unsigned asked_ = 0;           // questions at the rate whose turn it is
    unsigned asked_at_start_ = 0;  // since start()
    int turn_ = 1;
    bool heard_ = false;
    bool bytes_came_ = false;  // in this cycle
    Time quiet_until_{};
    Time deadline_{};
};

}  // namespace asip::session
