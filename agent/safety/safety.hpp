// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "agent/bridge/board.hpp"
#include "agent/bridge/effects.hpp"
#include "agent/counts/statistics.hpp"
#include "agent/inbound/inbound.hpp"
#include "agent/reports/board_values.hpp"
#include "agent/safety/holds.hpp"
#include "agent/safety/outputs.hpp"
#include "agent/safety/safe_lines.hpp"
#include "asip/bus/request/reply.hpp"
#include "asip/protocol/request.hpp"

namespace asip::agent {

/// The request that undoes `request`, by the model of its service; empty where none does or none is known.
std::string safe_form_of(const session::ServiceTable& services, const protocol::Request& request);

/// Makes the board safe when a hold is not renewed in time, when a user stops the board, and when the agent
/// ends. Needs neither bus nor sender for that. It counts on nothing but the board's own confirmation: each
/// line that makes the board safe is sent again until the board is known to have executed or refused it.
/// Pure; send() sends what is due.
class Safety {
  public:
    /// Stops whose answers are open. One more is obeyed, too, and answered at once as not confirmed.
    static constexpr std::size_t kMaxStops = 256;

    /// All must outlive it.
    Safety(Board& board, Statistics& statistics, BoardValues& values)
        : board_(board), statistics_(statistics), values_(values) {}

    // --- commands
    /// A request of anybody was queued. `safe`: safe_form_of() it.
    void queued(session::RequestId id, std::string_view line, const std::string& safe);
    Holds& holds() { return holds_; }
    const Holds& holds() const { return holds_; }
    /// Of a request of anybody, and of our own.
    void on_finished(const session::Finished& end, Time now, Effects& out);

    // --- the board
    /// All outputs are off, so that no hold is in force any more: each is reported.
    void board_restarted(Effects& out);
    /// The board is away, and what it does now cannot be known: commands with a hold are undone as soon as it
    /// is back.
    void board_gone(Effects& out);
    /// What the models of its services say is to be sent, once there is a board.
    void stop_services();

    // --- the bus
    /// Ends every hold and undoes everything. The requests that wait are refused by refuse_waiting().
    void on_stop(const Stop& message, Time now, session::Actions& actions, Effects& out);

    /// After on_stop(), before anything else: ends the requests that wait.
    void refuse_waiting(session::Actions& actions);

    /// Undoes all commands with a hold, because the agent ends. True: the board has not confirmed it yet.
    bool release_all();
    bool pending() const { return lines_.size() > 0; }

    /// Looks for holds that ended, and for stops whose time is over.
    void tick(Time now, Effects& out);
    void send(Time now, session::Actions& actions) { lines_.send(board_.session, now, actions); }
    std::optional<Time> next_deadline() const;

  private:
    /// One `$stop` that was not answered yet.
    struct OpenStop {
        bus::ReplyTo reply;
        std::set<std::string> open;
        std::vector<std::string> executed;
        std::size_t refused = 0;
        bool latched = false;  // it holds
        std::optional<SafeLines::Done> error;
        Time arrived;
        Time deadline;
    };

    void done(const SafeLines::Done& line, Time now, Effects& out);
    void report(const Holds::Hold& hold, const std::string& text, Effects& out);
    void answer(const OpenStop& stop, bool in_time, Time now, Effects& out);

    Board& board_;
    Statistics& statistics_;
    BoardValues& values_;
    Holds holds_;
    Outputs outputs_;
    SafeLines lines_;
    std::unordered_map<session::RequestId, std::string> requests_;  // -> safe form; bounded by the queue
    std::map<std::string, Holds::Hold> expired_;                    // by safe form, not yet undone
    std::vector<OpenStop> stops_;
};

}  // namespace asip::agent
