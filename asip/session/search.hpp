// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "asip/time.hpp"

namespace asip::session {

/// Looks for a board on a line of unknown rate: asks `#,?` at the start rate, then at each rate that boards
/// step up to, in cycles. A cycle with bytes that are no ASIP is followed by a longer one, since a busy
/// machine may answer late. TCP has one rate. Now and then more than a second passes without a question: a
/// 0.4 board inside a cut-off message goes on only then.
class Search {
  public:
    struct Step {
        unsigned baud = 0;  ///< to be at, 0: leave it
        bool ask = false;   ///< send the question; else only listen
        /// Ends a cut-off line; not always, since a 0.4 board may take it for a bad request.
        bool newline_first = false;
    };

    /// `quiet_until`: the board restarts; only listen until then. `turn`: of a search whose board turned out
    /// to be none, else 1. `patient`: a change of rate may restart the board, which is given 5 s at the start
    /// rate in each cycle.
    void start(unsigned start_baud, bool rates, int turn, Time quiet_until, Time now, bool patient = false);
    /// The factor by which rates have longer turns now: 1, 2 or 4.
    int turn() const { return turn_; }
    static int longer(int turn);
    Time next_deadline() const { return deadline_; }
    /// Call when the deadline has come.
    Step next(Time now);
    /// Something reads as ASIP: the next question is asked at this rate.
    void heard() { heard_ = true; }
    /// Bytes of any kind came.
    void bytes_came() { bytes_came_ = true; }

  private:
    std::size_t first_turn() const;

    std::vector<unsigned> rates_;
    std::size_t patient_turns_ = 1;  // at the start rate, of a first cycle
    std::size_t index_ = 0;
    std::size_t last_ = 0;         // where the question before was asked
    unsigned asked_ = 0;           // questions at the rate whose turn it is
    unsigned asked_at_start_ = 0;  // since start()
    int turn_ = 1;
    bool heard_ = false;
    bool bytes_came_ = false;  // in this cycle
    Time quiet_until_{};
    Time deadline_{};
};

}  // namespace asip::session
