// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "agent/bridge/board.hpp"
#include "agent/bridge/effects.hpp"
#include "agent/command/recent_answers.hpp"
#include "agent/counts/allowance.hpp"
#include "agent/counts/statistics.hpp"
#include "agent/inbound/command_age.hpp"
#include "agent/inbound/inbound.hpp"
#include "agent/reports/board_values.hpp"
#include "agent/reports/report_periods.hpp"
#include "agent/safety/safety.hpp"
#include "agent/safety/stop_latch.hpp"
#include "asip/model/command_encoder.hpp"
#include "asip/model/event_decoder.hpp"
#include "asip/protocol/request.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// Set in the client ids of the bus; those of point-to-point clients do not have it.
inline constexpr session::ClientId kBusClient = session::ClientId{1} << 63;

/// Commands of the bus: checks each by its service's model, queues it, and answers it exactly once, by its
/// deadline. Where no answer is wanted, a failure is reported on the service's error topic. A repeated
/// message is answered again and not executed again.
class Control {
  public:
    /// Refusals that are reported or noted at once, and in a second. All are counted.
    static constexpr double kRefusals = 100, kRefusalsPerSecond = 20;

    /// All references must outlive it.
    Control(Board& board, const CommandAge& age, Statistics& statistics, Safety& safety,
            ReportPeriods& periods, BoardValues& values, const StopLatch& latch)
        : board_(board),
          age_(age),
          statistics_(statistics),
          safety_(safety),
          periods_(periods),
          values_(values),
          latch_(latch) {}

    void on_command(const Command& command, Time now, session::Actions& actions, Effects& out);
    void on_renewal(const Renewal& renewal, Time now, Effects& out);
    /// Requests of others are ignored.
    void on_finished(const session::Finished& end, Time now, Effects& out);
    /// Reports on the service's error topic that a line of a point-to-point client was refused.
    void report_refused(std::string_view line, session::Refusal why, Time now, Effects& out);
    /// The same, because the board is stopped.
    void report_refused(std::string_view line, Time now, Effects& out);
    /// The sender (`by`) of the client's open commands; empty: unknown, or several.
    std::string sender_of(session::ClientId client) const;
    /// Empty: it is no link's request.
    std::string link_of(session::RequestId id) const;
    std::vector<std::pair<std::string, bus::Reply>> take_outcomes() { return std::exchange(outcomes_, {}); }
    std::uint64_t forgotten_answers() const { return recent_.dropped(); }

  private:
    /// A command from arrival to answer, shared by its requests that are under way. The last of them to end
    /// gives the answer.
    struct Execution {
        bus::ReplyTo reply;
        std::string service;                    // the topic's; empty: raw lines, each its own
        std::string link;                       // see Command
        std::string noted;                      // the request as it is noted; empty: it is not
        std::optional<RecentAnswers::Key> key;  // none: cannot be recognised again
        session::ClientId client = 0;
        Time received;
        Time sent;
        Time deadline;
        std::optional<Duration> hold;
        model::ModelPtr model;
        std::string encoded;               // the line of a command for a service
        std::vector<std::string> listed;   // the lines of a list of commands
        bool is_list = false;              // {"commands":[...]}: its answer is a list, too
        std::vector<std::string> answers;  // of a list: by the place of the command; empty: it has none
        std::size_t lines = 0;
        std::size_t open = 0;      // requests that have not ended
        std::size_t not_sent = 0;  // requests that ended so
        bool all_submitted = false;
        bus::Reply outcome = bus::Reply::ok("fence");
        bool is_proven() const { return reply.wanted() || !link.empty(); }
    };
    /// A request of a command, checked and not sent yet.
    struct Line {
        protocol::Request request;  // views into the command or into what Execution holds
        char answer_tag = 0;
        Duration answer_time = session::kDefaultAnswerTime;
        std::string safe{};  // what undoes it
    };
    /// A request under way, with what a report of its failure needs.
    struct Open {
        std::shared_ptr<Execution> execution;
        std::string service;
        std::string line;
        std::size_t place = 0;  // among the lines of the command
    };

    // In the order in which a command passes them.
    static std::shared_ptr<Execution> begin(const BusRequest& request);
    /// True: it is a repetition that was, or will be, answered.
    bool was_seen(Execution& execution, const Command& command, Time now, Effects& out);
    /// `service`: that of its topic; null: raw lines. Fails with a text for a person.
    Expected<std::vector<Line>> read(const Command& command, Execution& execution,
                                     const session::ServiceTable::Entry* service) const;
    /// The same for a command that is a list of commands.
    Expected<std::vector<Line>> read_list(const nlohmann::json& list, Execution& execution,
                                          const session::ServiceTable::Entry& service) const;
    /// `kept`: what the line is a view into.
    static Expected<Line> line_of(Expected<model::EncodedCommand> encoded, std::string& kept);
    /// The first raw line for which the client has no room, else empty. It reads none: a flood must cost
    /// little.
    std::string_view first_of_too_many(const Command& command, const Execution& execution) const;
    std::string hold_fault(const Execution& execution, const std::vector<Line>& lines) const;
    std::optional<session::Refusal> refusal(const std::vector<Line>& lines, session::ClientId client,
                                            Time now) const;
    void execute(const std::shared_ptr<Execution>& execution, const std::vector<Line>& lines, Time now,
                 session::Actions& actions, Effects& out);
    /// One of its requests has ended: what that means for the answer.
    void note_end(Execution& execution, std::size_t place, const session::Finished& end) const;
    /// `request`: how it is called in a report where no answer is wanted. `reason`: see bus/reply.hpp.
    void refuse(Execution& execution, std::string_view request, std::string_view reason, std::string text,
                Time now, Effects& out);
    /// Answers, remembers and notes the outcome. Once for each command.
    void conclude(Execution& execution, Time now, Effects& out);
    void report(std::string_view line, std::string_view reason, std::string_view error, Time now,
                Effects& out);
    void send(const bus::ReplyTo& to, bus::Reply reply, Time now, Effects& out) const;
    session::AnswerCheck answer_check(const Execution& execution) const;
    model::DecodeContext decode_context() const;
    std::string answer_json(const Execution& execution, const protocol::ParsedLine& line) const;

    Board& board_;
    const CommandAge& age_;
    Statistics& statistics_;
    Safety& safety_;
    ReportPeriods& periods_;
    BoardValues& values_;
    const StopLatch& latch_;
    RecentAnswers recent_;
    Allowance refusals_{kRefusals, kRefusalsPerSecond};
    std::vector<std::pair<std::string, bus::Reply>> outcomes_;
    std::unordered_map<session::RequestId, Open> open_;  // bounded by the session's queue
};

}  // namespace asip::agent
