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
#include "agent/counts/allowance.hpp"
#include "agent/counts/statistics.hpp"
#include "agent/inbound/inbound.hpp"
#include "agent/reports/board_values.hpp"
#include "agent/safety/holds.hpp"
#include "agent/safety/outputs.hpp"
#include "agent/safety/safe_lines.hpp"
#include "asip/bus/request/reply.hpp"
#include "asip/protocol/request.hpp"

namespace asip::agent {

/// The request that undoes `request`, by its service's model; empty: none is known.
std::string safe_form_of(const session::ServiceTable& services, const protocol::Request& request);

/// Makes the board safe when a hold is not renewed, a user stops the board, or the agent ends; without bus or
/// sender. Only the board's own confirmation counts: each line is sent again until it comes. Pure.
class Safety {
  public:
    /// Stops whose answers are open. A further one is obeyed, and answered at once as not confirmed.
    static constexpr std::size_t kMaxStops = 256;
    static constexpr std::size_t kMaxStopsOfAsker = 32;

    /// All must outlive it.
    Safety(Board& board, Statistics& statistics, BoardValues& values)
        : board_(board), statistics_(statistics), values_(values) {}

    // --- commands
    /// To be called for each request that is queued. `safe`: its safe_form_of().
    void queued(session::RequestId id, std::string_view line, const std::string& safe);
    Holds& holds() { return holds_; }
    const Holds& holds() const { return holds_; }
    /// To be called when any request ends, ours included.
    void on_finished(const session::Finished& end, Time now, Effects& out);

    // --- the board
    /// Each hold that ended so is reported; what the session restores can be undone.
    void board_restarted(Effects& out);
    /// What the board does is unknown: commands with a hold are undone as soon as it is back.
    void board_gone(Effects& out);
    /// Stops what the models say, once there is a board.
    void stop_services();

    // --- the bus
    /// Ends every hold and undoes everything; refuse_waiting() is to follow at once.
    void on_stop(const Stop& message, Time now, session::Actions& actions, Effects& out);

    /// Ends the requests that wait.
    void refuse_waiting(session::Actions& actions);

    /// Undoes all commands with a hold at the end of the agent. True: the board has not confirmed it yet.
    bool release_all();
    bool pending() const { return lines_.size() > 0; }

    /// Ends holds and stops whose time is over.
    void tick(Time now, Effects& out);
    void send(Time now, session::Actions& actions);
    std::optional<Time> next_deadline() const;

  private:
    /// A `$stop` that is not answered yet.
    struct OpenStop {
        bus::ReplyTo reply;
        std::string asker;
        std::set<std::string> open;
        std::vector<std::string> executed;
        std::size_t refused = 0;
        bool latched = false;  // it holds
        std::optional<SafeLines::Done> error;
        Time arrived;
        Time deadline;
    };

    /// A safe form as the board gets it: where low means on, high is safe.
    std::string wire(const std::string& safe) const;
    void make_safe(const std::string& line);
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
    Allowance notes_of_stops_{100, 20};  // behind a flood of them the answers to commands would wait
};

}  // namespace asip::agent
