// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>
#include <vector>

#include "tests/truth/board/firmware.hpp"
#include "tests/truth/exhaustive/scenario.hpp"
#include "tests/truth/ledger.hpp"
#include "tests/truth/world.hpp"

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

/// When in the undisturbed history: the board was ready for the first command, and something was under way
/// for the last time in which a fault is tried. 0: not known, nothing may go wrong.
struct Times {
    Micros ready = 0;
    Micros last = 0;
};

struct TrialEnd {
    std::string failure;  ///< empty: all that was asserted is so
    Counts counts;
    std::vector<std::string> trace;  ///< if asked for
    Range to_board, to_host;         ///< what the scenario sent, from its `from` on
    std::vector<Micros> moments;     ///< when something happened meanwhile
    Times times;
    Micros recovered_after = 0;  ///< from the end of the last fault to the last command, which is `ok`
};

/// One history of a scenario, with faults at known places. Asserted, beside what the ledger asserts of each
/// answer: the session is ready again within `kRecovery` of the last fault's end, a command then is `ok`, and
/// what clients had set is in force. Commands come at the same time in each history.
class Trial : World {
  public:
    /// `times`: of the undisturbed history.
    Trial(const Scenario& scenario, const Faults& faults, Times times, bool trace);

    TrialEnd run();

  private:
    static Setting setting_of(const Scenario& scenario, const Faults& faults, Times times, bool trace);
    void on_fault(const WireByte& byte) override;
    void on_read(const BoardRead& read) override;
    void on_board_off() override;
    void on_incident(const Incident& incident) override;
    Micros next_step() const;
    void begin();
    void steps();
    void step(const Step& step);
    void check_holds();
    void watch();
    void check_settings();
    void check_levels();
    void close();
    /// One step; false: the end.
    bool pass_on();
    std::string last_line() const;
    bool all_well() const;

    const Scenario& scenario_;
    bool undisturbed_;
    TrialEnd end_;
    std::size_t next_step_ = 0;
    Micros faults_end_ = 0;
    Micros busy_at_ = 0;  // something was under way
    Micros last_at_ = kNever;
    bool ready_ = false;
    bool rate_asked_ = false;
    int closing_ = 0;                // last commands that were sent
    std::map<unsigned, int> modes_;  // of the board's pins since it restarted
    std::map<unsigned, int> levels_;
    Micros off_at_ = 0;          // the board, for the last time
    Micros held_from_ = kNever;  // the last renewal, or the beginning
};

/// Plays a history from its beginning to its end.
TrialEnd run_trial(const Scenario& scenario, const Faults& faults, Times times, bool trace);

/// So long nothing may be under way before a command that comes when all is well again.
constexpr Micros kQuiet = 20 * kMillisecond;
constexpr Micros kRecovery = 15 * kSecond;

}  // namespace truth
