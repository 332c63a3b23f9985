// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "sim/program/live_board.hpp"

namespace asip::sim {

/// A board whose chip is simulated in this process.
class AvrBoard : public LiveBoard {
  public:
    static Expected<std::unique_ptr<LiveBoard>> create(BoardFile file, Reporter& reporter);

    std::vector<std::string> part_names() const override;
    Pace tick(Time now) override;
    void add_waits(std::vector<pollfd>& waits) const override;
    Expected<std::string> command(std::string_view verb, std::string_view part, std::string_view argument,
                                  Time now) override;

  private:
    AvrBoard(BoardFile file, Reporter& reporter, std::unique_ptr<Board> board);
    SimTime board_time() const override { return board_->now(); }
    Expected<std::string> plug(bool in, Time now);
    std::string list() const;

    bool has_room() const;
    void receive_from_ports(bool pty_readable);
    Pty::Events notice_opening();
    void follow_host_rate();
    bool run_towards(Time now);
    void report_losses(Time now);

    std::unique_ptr<Board> board_;
    Time busy_until_{};

    Time started_{};  // the moment at which the board's time was started_at_
    SimTime started_at_{0};
    Time next_housekeeping_{};
    SimTime skipped_{0};  // what it lagged behind and gave up
    LineErrors reported_;
    bool reported_dead_ = false;
};

}  // namespace asip::sim
