#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "asip/protocol/line_reader.hpp"
#include "asip/protocol/message.hpp"
#include "asip/session/board_session.hpp"
#include "asip/session/interview.hpp"
#include "asip/session/rate_change.hpp"
#include "asip/session/request_queue.hpp"
#include "asip/session/search.hpp"
#include "asip/session/settings_memory.hpp"

namespace asip::session {

/// What is behind BoardSession: the folds, and what leads from one to the other. Finding the board, taking
/// its lines, and requests and time have a source file each.
class BoardSession::Impl {
  public:
    explicit Impl(SessionOptions options) : options_(options) {}

    void link_up(const LinkTraits& traits, Time now, Actions& out);
    void link_down(Actions& out);
    void receive(std::string_view bytes, Time now, Actions& out);
    void tick(Time now, Actions& out);
    void line_rate_set(bool ok, Time now, Actions& out);
    Expected<RequestId, Refusal> submit(std::string_view line, const RequestOptions& request, Time now,
                                        Actions& out);
    std::optional<Time> next_deadline() const;

    SessionOptions options_;
    State state_ = State::kDown;
    Identity identity_;
    SessionCounters counters_;
    SettingsMemory settings_;
    RequestQueue queue_;
    unsigned baud_ = 0;

  private:
    void search(Time quiet_until, Time now, Actions& out);
    void search_step(Time now, Actions& out);
    void interview(Time now, Actions& out);
    void follow_interview(Time now, Actions& out);
    void set_up_line(Time now, Actions& out);
    void follow_rate_change(Time now, Actions& out);
    void become_ready(Time now, Actions& out);
    void board_restarted(std::string why, Time now, Actions& out);
    void fall_silent(Time now, Actions& out);

    void on_line(std::string_view line, Time now, Actions& out);
    void on_message(const protocol::Event& event, std::string_view line, Time now, Actions& out);
    void on_message(const protocol::ErrorReply& error, std::string_view line, Time now, Actions& out);
    void on_message(const protocol::Info& info, std::string_view line, Time now, Actions& out);
    void on_message(const protocol::Malformed& malformed, std::string_view line, Time now, Actions& out);
    void garbage(std::string reason, std::string_view line, Time now, Actions& out);
    bool take_checksum(std::string_view& line, Time now, Actions& out);

    void write(const std::vector<std::string>& lines, Actions& out);
    void set_rate(unsigned baud, std::string why, Actions& out);
    void pump(Time now, Actions& out);
    void report(std::vector<RequestQueue::End>& ended, Time now, Actions& out);
    void executed(const RequestQueue::Request& request, Time now, Actions& out);

    bool link_has_rates() const { return start_baud_ != 0; }

    protocol::LineReader reader_;
    std::uint64_t overlong_seen_ = 0;
    Search search_;
    Interview interview_;
    RateChange rate_change_;
    unsigned start_baud_ = 0;
    RequestId next_id_ = 1;
    bool known_ = false;           // identified at least once, since construction
    bool was_silent_ = false;      // state to report while searching
    bool no_answer_said_ = false;  // since link_up, or need not be: it answered
    bool checksum_on_ = false;
    bool restore_ = false;
    std::string banner_services_;
    unsigned suspect_baud_ = 0;  // rate at which there was too much garbage
    unsigned ready_baud_ = 0;    // rate at which the board was last ready
    Time link_up_at_{};
    Time last_heard_{};
    Time window_start_{};
    unsigned window_garbage_ = 0;
};

}  // namespace asip::session
