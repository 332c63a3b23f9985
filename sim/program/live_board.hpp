// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "asip/time.hpp"
#include "sim/board_file.hpp"
#include "sim/program/pty.hpp"
#include "sim/program/reporter.hpp"
#include "sim/program/tcp_port.hpp"

namespace asip::sim {

/// When a board wants to run on.
enum class Pace {
    kBehind,  ///< at once: it has not caught up with the clock
    kBusy,    ///< soon: bytes are on its line
    kIdle,    ///< when its host or its parts have something for it, or after a millisecond
};

/// A board that runs by the computer's clock and that programs reach through its ports. Used by one thread at
/// a time.
class LiveBoard {
  public:
    /// The reporter outlives it. Opens the ports and reports them.
    static Expected<std::unique_ptr<LiveBoard>> create(BoardFile file, Reporter& reporter);
    virtual ~LiveBoard() = default;
    LiveBoard(const LiveBoard&) = delete;
    LiveBoard& operator=(const LiveBoard&) = delete;

    const std::string& name() const { return file_.board.name; }

    virtual std::vector<std::string> part_names() const = 0;

    /// Carries bytes between the ports and the board and lets it run up to `now`, but not for long.
    virtual Pace tick(Time now) = 0;

    /// What becomes readable when the host has something for the board.
    virtual void add_waits(std::vector<pollfd>& waits) const = 0;

    /// "press button1", "reset", "unplug", "replug", "list"; the answer's lines, or what was wrong.
    virtual Expected<std::string> command(std::string_view verb, std::string_view part,
                                          std::string_view argument, Time now) = 0;

  protected:
    LiveBoard(BoardFile file, Reporter& reporter) : file_(std::move(file)), reporter_(reporter) {}

    Expected<void> open_pty();
    /// All of them, and reports them.
    Expected<void> open_ports();
    void close_ports();
    void send_to_ports();
    /// "/dev/pts/3 link", or "unplugged".
    std::string shown_port() const;
    virtual SimTime board_time() const = 0;
    void happened(std::string_view event, const nlohmann::ordered_json& details);

    BoardFile file_;
    Reporter& reporter_;
    Pty pty_;
    PortLink link_;
    TcpPort tcp_;
    bool plugged_ = true;
    bool pty_in_use_ = false;
    std::string to_host_;
};

}  // namespace asip::sim
