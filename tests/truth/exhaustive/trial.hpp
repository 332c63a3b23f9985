// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "tests/truth/exhaustive/scenario.hpp"
#include "tests/truth/ledger.hpp"

namespace truth {

/// What goes wrong in one history.
struct Faults {
    std::vector<ByteFault> to_board, to_host;
    std::vector<Incident> incidents;
};
std::string describe(const Faults& faults);

/// Bytes of one direction, by number.
struct Range {
    std::uint64_t from = 0;
    std::uint64_t until = 0;
};

struct TrialEnd {
    std::string failure;  ///< empty: all that was asserted is so
    Counts counts;
    std::vector<std::string> trace;  ///< if asked for
    Range to_board, to_host;         ///< what the scenario sent, from its `from` on
    std::vector<Micros> moments;     ///< when something happened meanwhile
    Micros ready_at = 0;             ///< for the first time
    Micros recovered_after = 0;      ///< from the end of the last fault to the last command, which is `ok`

    /// Whether two histories came to the same.
    bool same(const TrialEnd& other) const {
        return failure == other.failure && counts == other.counts && recovered_after == other.recovered_after;
    }
};

/// Plays a scenario, with faults at known places. Asserted, beside what the ledger asserts of each answer:
/// the session is ready again within `kRecovery` of the last fault's end, a command then is `ok`, and what
/// clients had set is in force.
/// `ready_at`: when it is ready where nothing goes wrong, so that commands come at the same time in each
/// trial; 0: not known, nothing may go wrong.
TrialEnd run_trial(const Scenario& scenario, const Faults& faults, Micros ready_at, bool trace);

/// The history of a scenario in which nothing goes wrong, and points of it from which others go on that
/// differ from there on only. What it was made of must outlive it.
class Undisturbed {
  public:
    explicit Undisturbed(const Scenario& scenario);
    ~Undisturbed();

    /// How it ended.
    const TrialEnd& end() const { return end_; }
    /// As run_trial(), in less time.
    TrialEnd run(const Faults& faults) const;

  private:
    struct Point;
    const Scenario& scenario_;
    TrialEnd end_;
    std::vector<Point> points_;  // as time passes
};

constexpr Micros kRecovery = 15 * kSecond;

}  // namespace truth
