// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <random>
#include <string>
#include <vector>

#include "tests/unit/session/scripted_board.hpp"

namespace asip::session {

/// How often something happens to a byte on its way, one in so many; 0: never. To one line at most once: two
/// faults may make another valid line of it, and cancel each other out in its checksum.
struct Faults {
    unsigned lost = 0;
    unsigned doubled = 0;
    unsigned changed = 0;
    unsigned stalled = 0;  ///< it and all behind it come up to 3 s later
};

/// One direction of a line: bytes come out in order, each at its time.
class DamagedLine {
  public:
    explicit DamagedLine(std::mt19937_64& random) : random_(random) {}

    Faults faults;

    void push(std::string_view bytes, Duration byte_time, Time now);
    Time next() const { return bytes_.empty() ? Time::max() : bytes_.front().first; }
    /// What has arrived by now.
    std::string take(Time now);
    void clear() { bytes_.clear(); }
    std::uint64_t faults_done() const { return faults_done_; }

  private:
    bool happens(unsigned one_in);

    std::mt19937_64& random_;
    std::deque<std::pair<Time, char>> bytes_;
    Time last_{};
    bool line_damaged_ = false;
    std::uint64_t faults_done_ = 0;
};

struct HistoryOptions {
    bool extensions = true;
    ChecksumPolicy checksum = ChecksumPolicy::kAuto;
    unsigned max_baud = 0;
    Faults to_board;
    Faults from_board;
    bool restarts = true;  ///< the board restarts, goes mute for a while, the link goes and comes back
    Duration length = 30s;
};

/// What was counted in one history, and every sentence about what must not have happened.
struct Verdict {
    int commands = 0;
    int executed = 0;
    int doubts = 0;
    int not_sent = 0;
    std::uint64_t faults = 0;
    std::vector<std::string> violations;
};

/// One random history in simulated time: several clients, a line with these faults, a board that restarts and
/// falls silent. The same seed gives the same history.
Verdict run_history(std::uint64_t seed, const HistoryOptions& options);

}  // namespace asip::session
