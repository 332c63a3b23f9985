// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "agent/bridge/effects.hpp"
#include "agent/command/recent_answers.hpp"
#include "agent/counts/statistics.hpp"
#include "agent/reports/report_periods.hpp"
#include "agent/safety/safety.hpp"
#include "asip/bus/agent_clock.hpp"
#include "asip/bus/request_envelope.hpp"
#include "asip/bus/topics.hpp"
#include "asip/model/event_decoder.hpp"
#include "asip/session/board_session.hpp"
#include "asip/session/service_table.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// Set in the client ids of the bus; those of point-to-point clients do not have it.
inline constexpr session::ClientId kBusClient = session::ClientId{1} << 63;

/// By when a request has to be done, by what it says, its expiry, or as usual. `arrived`, `sent`: when that
/// was, at the earliest.
Time deadline_of(const bus::RequestEnvelope& envelope, const mqtt::Message& message, Time arrived, Time sent);
/// When it was sent, at the latest: as it told by our clock, else when it arrived.
Time sent_at(std::optional<Time> told, Time arrived);

/// The control bus: takes the envelope off, checks the command by its model, queues it on the session, and
/// sees that whoever asked for an answer gets exactly one, in time. What fails for those who asked for none
/// is reported on the service's error topic.
class Control {
  public:
    Control(const bus::Topics& topics, const session::BoardSession& session, const bus::AgentClock& clock,
            Statistics& statistics, Safety& safety, ReportPeriods& periods)
        : topics_(topics),
          session_(session),
          clock_(clock),
          statistics_(statistics),
          safety_(safety),
          periods_(periods) {}

    struct Arrival {
        Time at;
        bool stopped = false;  ///< the board was stopped after it came: it is refused
    };
    /// A message on one of the board's topics for requests.
    void on_message(const mqtt::Message& message, const Arrival& arrival,
                    const session::ServiceTable& services, session::BoardSession& session, Time now,
                    session::Actions& actions, Effects& out);
    /// True: the request was one of ours.
    bool on_finished(const session::Finished& end, Time now, Effects& out);
    /// A line that came by another way than the bus was refused: reported on the error topic of its service.
    void report_refused(const std::string& board, std::string_view line, session::Refusal why,
                        const session::ServiceTable& services, Effects& out) const;
    /// Who sent what is open of this client; empty: not known, or several.
    std::string sender_of(session::ClientId client) const;
    /// Answers that were forgotten before their minute was over.
    std::uint64_t forgotten_answers() const { return recent_.dropped(); }

  private:
    /// One payload: one answer for all its lines.
    struct Command {
        bus::ReplyTo reply;
        std::string board;
        std::string service;                    // the topic's; empty: raw lines, each its own
        std::string noted;                      // the request as it is noted; empty: it is not
        std::optional<RecentAnswers::Key> key;  // none: cannot be recognised again
        session::ClientId client = 0;
        Time arrived;
        Time sent;
        Time deadline;
        std::optional<Duration> hold;
        const model::ServiceModel* model = nullptr;
        model::ModelPtr model_owner;
        std::size_t lines = 0;
        std::size_t open = 0;      // requests that have not ended
        std::size_t not_sent = 0;  // requests that ended so
        bool all_sent = false;
        bus::Reply outcome = bus::Reply::ok("fence");
    };
    struct Line {
        std::string text;
        char answer_tag = 0;
        Duration answer_time = session::kDefaultAnswerTime;
        std::string safe{};  // what undoes it
    };
    struct Open {
        std::shared_ptr<Command> command;
        std::string service;
        std::string line;
    };

    void execute(std::shared_ptr<Command> command, const std::vector<Line>& lines,
                 const session::ServiceTable& services, session::BoardSession& session, Time now,
                 session::Actions& actions, Effects& out);
    bool was_seen(Command& command, const mqtt::Message& message, std::optional<Time> sent, Time now,
                  Effects& out);
    void renew(Command& command, const bus::RequestEnvelope& envelope, Time now, Effects& out);
    std::string hold_fault(const Command& command, const std::vector<Line>& lines) const;
    void refuse(Command& command, std::string_view request, std::string_view reason, std::string text,
                Time now, Effects& out);
    std::optional<session::Refusal> refusal(const std::vector<Line>& lines, session::ClientId client,
                                            const session::BoardSession& session) const;
    void note_end(Command& command, const session::Finished& end) const;
    void conclude(Command& command, Time now, Effects& out);
    void send(const bus::ReplyTo& to, bus::Reply reply, Time now, Effects& out) const;
    Expected<std::vector<Line>> read(const bus::RequestEnvelope& envelope,
                                     const session::ServiceTable::Entry* service,
                                     const session::ServiceTable& services) const;
    session::AnswerCheck answer_check(const Command& command) const;
    model::DecodeContext decode_context() const;
    std::string answer_json(const Command& command, const protocol::ParsedLine& line) const;

    bus::Topics topics_;
    const session::BoardSession& session_;
    const bus::AgentClock& clock_;
    Statistics& statistics_;
    Safety& safety_;
    ReportPeriods& periods_;
    RecentAnswers recent_;
    std::unordered_map<session::RequestId, Open> open_;  // bounded by the session's queue
};

}  // namespace asip::agent
