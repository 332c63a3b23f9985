// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "asip/time.hpp"
#include "sim/board.hpp"
#include "sim/board_file.hpp"
#include "sim/program/pty.hpp"
#include "sim/program/reporter.hpp"
#include "sim/program/tcp_port.hpp"

namespace asip::sim {

enum class Pace {
    kBehind,  ///< at once: it has not caught up with the clock
    kBusy,    ///< soon: bytes are on its line
    kIdle,    ///< when its host or its parts have something for it, or after a millisecond
};

/// A board in real time, reached through its ports. One thread at a time.
class LiveBoard {
  public:
    /// Opens the ports and reports them.
    static Expected<std::unique_ptr<LiveBoard>> create(BoardFile file, Reporter& reporter);
    LiveBoard(const LiveBoard&) = delete;
    LiveBoard& operator=(const LiveBoard&) = delete;

    const std::string& name() const { return file_.board.name; }

    std::vector<std::string> part_names() const;

    /// Carries bytes, and runs the board up to `now`, but not for long.
    Pace tick(Time now);

    /// Readable: the host has something for the board.
    void add_waits(std::vector<pollfd>& waits) const;

    /// "press button1", "reset", "unplug", "replug", "list".
    Expected<std::string> command(std::string_view verb, std::string_view part, std::string_view argument,
                                  Time now);

  private:
    LiveBoard(BoardFile file, Reporter& reporter, std::unique_ptr<Board> board);

    Expected<void> open_pty();
    Expected<void> open_ports();
    void close_ports();
    void send_to_ports();
    /// "/dev/pts/3 link", or "unplugged".
    std::string shown_port() const;
    void happened(std::string_view event, const nlohmann::ordered_json& details);

    Expected<std::string> plug(bool in, Time now);
    std::string list() const;

    bool has_room() const;
    void receive_from_ports(bool pty_readable);
    Pty::Events notice_opening();
    void follow_host_rate();
    bool run_towards(Time now);
    void report_losses(Time now);

    BoardFile file_;
    Reporter& reporter_;
    std::unique_ptr<Board> board_;
    Pty pty_;
    PortLink link_;
    TcpPort tcp_;
    bool plugged_ = true;
    bool pty_in_use_ = false;
    std::string to_host_;
    Time busy_until_{};

    Time started_{};  // the moment at which the board's time was started_at_
    SimTime started_at_{0};
    Time next_housekeeping_{};
    SimTime skipped_{0};  // what it lagged behind and gave up
    LineErrors reported_;
    bool reported_dead_ = false;
};

}  // namespace asip::sim
