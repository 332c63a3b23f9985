// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "asip/protocol/message.hpp"
#include "asip/session/board_session.hpp"
#include "asip/session/interview.hpp"
#include "asip/session/name_budget.hpp"
#include "asip/session/rate_change.hpp"
#include "asip/session/request_queue.hpp"
#include "asip/session/search.hpp"
#include "asip/session/settings_memory.hpp"
#include "asip/session/wire.hpp"

namespace asip::session {

/// Behind BoardSession: what is known in every state, and one state with its own data and source file;
/// machine.cpp leads from one to the other.
class Machine {
  public:
    Machine(SessionOptions options, const Random& random);

    void link_up(const LinkTraits& traits, Time now, Actions& out);
    void link_down(Time now, Actions& out);
    void receive(std::string_view bytes, Time now, Actions& out);
    void tick(Time now, Actions& out);
    void line_rate_set(bool ok, Time now, Actions& out);
    void not_watched(Time since, Time now);
    Expected<RequestId, Refusal> submit(std::string_view line, const RequestOptions& options, Time now,
                                        Actions& out);
    Expected<RequestId, Refusal> submit(const protocol::Request& parsed, const RequestOptions& options,
                                        Time now, Actions& out);
    std::size_t cancel_waiting(Actions& out);
    void leave(Leave how, Time now, Actions& out);
    void hold_outputs(bool hold);
    void will_execute(std::string_view line);
    bool accepts_requests() const { return there_ && !leaving_; }
    std::size_t room(ClientId client) const;
    unsigned names_left(Time now) const { return names_.left(now); }
    std::optional<Time> next_deadline() const;

    BoardSession::State state() const;
    const Identity& identity() const { return identity_; }
    const SessionCounters& counters() const { return counters_; }
    const SettingsMemory& settings() const { return settings_; }
    const RequestQueue& requests() const { return queue_; }
    const Wire& wire() const { return wire_; }

  private:
    struct Down {};
    struct Searching {
        Search search;
        Time since;
        bool switched = false;  // checksums, with the question that is open
    };
    struct Identifying {
        Interview interview;
        int turn = 1;          // of the search before it
        bool answers = false;  // something that reads as ASIP came since the question
    };
    struct SteppingUp {
        RateChange change;
    };
    struct Ready {
        Time garbage_since;
        unsigned garbage = 0;
    };
    using State = std::variant<Down, Searching, Identifying, SteppingUp, Ready>;

    // From state to state (machine.cpp). What a reference to the state before pointed to is gone after these.
    void search(Time quiet_until, Time now, Actions& out);
    void identify(Time now, Actions& out);
    void set_up_line(Identity found, Time now, Actions& out);
    void become_ready(Time now, Actions& out);
    void board_restarted(std::string why, Time now, Actions& out);
    void fall_silent(Time now, Actions& out);

    // Searching (searching.cpp)
    void ask(Searching& state, Time now, Actions& out);
    void on_event(Searching& state, const protocol::Event& event, std::string_view line, Time now,
                  Actions& out);
    void on_error(Searching& state, const protocol::ErrorReply& error, std::string_view line, Time now,
                  Actions& out);
    void on_garbage(Searching&, Time, Actions&) {}
    void on_time(Searching& state, Time now, Actions& out);
    Time deadline(const Searching& state) const;

    // Identifying and SteppingUp (identifying.cpp, stepping_up.cpp)
    void on_event(Identifying& state, const protocol::Event& event, std::string_view line, Time now,
                  Actions& out);
    void on_error(Identifying& state, const protocol::ErrorReply& error, std::string_view line, Time now,
                  Actions& out);
    void on_garbage(Identifying&, Time, Actions&) {}
    void on_time(Identifying& state, Time now, Actions& out);
    Time deadline(const Identifying& state) const;
    void follow(Identifying& state, Time now, Actions& out);
    bool is_believed(const Identity& found);
    Interview new_interview(Time now, std::vector<std::string>& lines);

    void on_event(SteppingUp& state, const protocol::Event& event, std::string_view line, Time now,
                  Actions& out);
    void on_error(SteppingUp& state, const protocol::ErrorReply& error, std::string_view line, Time now,
                  Actions& out);
    void on_garbage(SteppingUp& state, Time now, Actions& out);
    void on_time(SteppingUp& state, Time now, Actions& out);
    Time deadline(const SteppingUp& state) const;
    void follow(SteppingUp& state, Time now, Actions& out);

    // Ready (ready.cpp)
    void on_event(Ready& state, const protocol::Event& event, std::string_view line, Time now, Actions& out);
    void on_error(Ready& state, const protocol::ErrorReply& error, std::string_view line, Time now,
                  Actions& out);
    void on_garbage(Ready& state, Time now, Actions& out);
    void on_time(Ready& state, Time now, Actions& out);
    Time deadline(const Ready& state) const;
    void pump(Time now, Actions& out);
    void switch_checksums();
    SelfReports self_reports(const Request& request) const;
    void note_report(const protocol::Event& event, Time now);

    // What boards of ASIP 0.4 stop by themselves (report_renewal.cpp)
    struct Renewal {
        Time asked{};     // when the period was last set
        Time reported{};  // the last report
        Duration patience{};
        bool pending = false;              // it is being set
        Duration gap{};                    // between reports that no request asked for, on average
        int gaps = 0;                      // that are in `gap`
        std::optional<unsigned> measured;  // the board's own period in ms
    };
    void note_renewed(char service);
    void renew_behind(const protocol::Event& event, Time now);
    void note_unasked(const protocol::Event& event, Time now);
    std::optional<unsigned> renewed_period(char service, const Renewal& renewal) const;
    void renew(char service, Renewal& renewal);
    Time missing_at(char service, const Renewal& renewal) const;
    void renew_missing(Time now);
    Time next_renewal() const;

    // What clients had set (restoring.cpp)
    void restore_settings();
    bool keeps_level() const;

    // The end (leaving.cpp)
    void leave_once_quiet(Time now, Actions& out);
    void give_back(Time now, Actions& out);
    void has_left();

    void on_event(Down&, const protocol::Event&, std::string_view, Time, Actions&) {}
    void on_error(Down&, const protocol::ErrorReply&, std::string_view, Time, Actions&) {}
    void on_garbage(Down&, Time, Actions&) {}
    void on_time(Down&, Time, Actions&) {}
    Time deadline(const Down&) const { return Time::max(); }

    // Lines from the board, in any state (machine_lines.cpp)
    void on_line(std::string_view line, Time now, Actions& out);
    void on_info(const protocol::Info& info, std::string_view line, Time now, Actions& out);
    void on_malformed(std::string_view reason, std::string_view line, Time now, Actions& out);
    void garbage(std::string reason, std::string_view line, Time now, Actions& out);
    void note_garbage(std::string reason, std::string_view line, Actions& out);
    void damaged();

    void write(const std::vector<std::string>& lines, Time now, Actions& out);
    void note_period(const RequestEnd& end);
    void report(std::vector<RequestEnd>& ended, Actions& out);
    void abandon_in_flight(Ending ending, Actions& out);
    bool has_checksums() const;
    bool wants_checksums() const;
    std::optional<Time> gone_at() const;

    SessionOptions options_;
    State state_;
    Wire wire_;
    RequestQueue queue_;
    SettingsMemory settings_;
    Rates rates_;
    Identity identity_;
    struct Unconfirmed {
        Identity said;
        int times;  // it was asked again
    };
    std::optional<Unconfirmed> unconfirmed_;  // the board seems to be another one
    SessionCounters counters_;
    std::string token_start_;
    std::uint64_t overlong_seen_ = 0;
    RequestId next_id_ = 1;
    NameBudget names_;
    bool known_ = false;               // identified at least once, since construction
    bool there_ = false;               // identified since link_up, and not gone since
    bool was_silent_ = false;          // state to report while searching
    bool no_answer_reported_ = false;  // since link_up, or need not be: it answered
    bool damage_seen_ = false;         // on this line, at any time
    bool checksums_seen_ = false;      // the board sent one, or asked for one, while we sent none
    bool changed_ = false;             // the next Identified is of another board than the last
    bool restore_ = false;             // settings are to be restored once the board is ready
    bool restore_again_ = false;       // it may not have executed one of those that were restored
    Time restored_again_at_{};
    enum class Outputs { kFree, kHeld, kOwed };  // kOwed: some were not restored, since they are held
    Outputs outputs_ = Outputs::kFree;
    std::string banner_services_;
    unsigned suspect_baud_ = 0;  // rate at which there was too much garbage
    unsigned ready_baud_ = 0;    // rate at which the board was last ready
    struct Report {
        char service;
        char tag;
        Time last;
    };
    std::vector<Report> reports_;  // what the board sends by itself
    struct NewPeriod {
        char service;
        bool in_doubt;  // unknown whether it is in force
        Time at;
    };
    std::vector<NewPeriod> new_periods_;  // the last one of each service
    std::map<char, Renewal> renewals_;    // of services whose period was set on a board of ASIP 0.4
    Time last_report_{};
    Time progress_at_{};   // while it is not ready: link_up, the end of its being ready, its last answer
    bool banner_ = false;  // one came since link_up
    std::optional<Time> found_at_;  // its first interview since it was ready
    Time last_byte_{};
    std::optional<Time> asked_at_;  // the first question since the last byte
    struct Leaving {
        Time until;  // of this step
        bool asked;  // to return to the start rate
    };
    std::optional<Leaving> leaving_;
};

}  // namespace asip::session
