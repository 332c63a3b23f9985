#pragma once
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/protocol/message.hpp"
#include "asip/session/action.hpp"
#include "asip/time.hpp"

namespace asip::session {

/// The fold that paces requests and proves them. At most kMaxInFlightBytes are out that no fence has proven
/// executed; the requests between two fences are told apart by service and tag, so that an error belongs to
/// one of them; where two would look alike, a fence goes between. A 0.4 board has no tokens in its fences
/// (`#,?`): one is out at a time.
class RequestQueue {
  public:
    static constexpr std::size_t kMaxInFlightBytes = 48;

    struct Request {
        RequestId id = 0;  ///< 0: the session's own, its end is not told
        std::string line;
        bool prove = true;
        char answer_tag = 0;
        bool alone = false;  ///< nothing else between its fences: its error would not name it
    };
    /// How a request ended, its own included.
    struct End {
        Request request;
        Ending ending;
        int code = 0;
        std::string text;
        std::string answer;
    };

    /// Whether the board has the echo extension; said after identification.
    void use_echo(bool echo) { echo_ = echo; }
    /// Bytes each line gets more on the wire (checksum). Then one request is out at a time.
    void set_line_overhead(std::size_t bytes) { overhead_ = bytes; }

    void push(Request request) { waiting_.push_back(std::move(request)); }
    void push_front(Request request) { waiting_.push_front(std::move(request)); }

    /// Lines to write now, without line end, in order.
    std::vector<std::string> pump(Time now);

    /// An event line. True: it was our fence, nobody else's business. `ended` is appended to.
    bool on_event(const protocol::Event& event, std::string_view line, std::vector<End>& ended);
    /// An error line. Whether or not it belongs to a request, others may want to see it.
    void on_error(const protocol::ErrorReply& error, std::vector<End>& ended);
    /// A fence that did not come back: everything in flight times out, and nothing but fences is sent until
    /// one is back.
    void on_deadline(Time now, Duration answer_timeout, std::vector<End>& ended);

    /// The link or the board went: what is in flight times out. The rest stays.
    void abandon_in_flight(std::vector<End>& ended);
    /// The board was found again: no fence of before is owed any more.
    void restart();
    /// And what waits is not sent.
    void abandon_waiting(std::vector<End>& ended);

    /// A fence with nothing before it, to see whether the board lives. Nothing when one is out already.
    void probe();

    std::optional<Time> next_deadline(Duration answer_timeout) const;
    std::size_t bytes_in_flight() const { return in_flight_; }
    std::size_t waiting() const { return waiting_.size(); }
    bool idle() const { return waiting_.empty() && batches_.empty(); }
    /// Fences lost in a row.
    unsigned lost_fences() const { return lost_fences_; }
    std::uint64_t fence_timeouts() const { return fence_timeouts_; }

  private:
    struct Item {
        Request request;
        char service;
        char tag;
        bool answered = false;
        bool refused = false;
        std::string answer;
    };
    struct Batch {
        std::vector<Item> items;
        std::string token;  // empty: no fence sent yet
        std::size_t bytes = 0;
        Time last_sent{};
        bool wants_proof() const;
    };

    Batch* open_batch();
    bool conflicts(const Batch& batch, const Request& next) const;
    bool may_fence() const;
    std::size_t fence_bytes() const;
    void close(Batch& batch, Time now, std::vector<std::string>& lines);
    void send(Request request, Time now, std::vector<std::string>& lines);
    std::string next_token();
    bool on_fence(std::string_view token, std::vector<End>& ended);
    void finish_front(std::vector<End>& ended, bool proven);
    bool note_answer(const protocol::Event& event, std::string_view line);
    bool is_own_question(const protocol::Event& event);

    bool echo_ = false;
    std::size_t overhead_ = 0;
    bool stalled_ = false;  // a fence was lost; only fences go out until one is back
    bool probe_wanted_ = false;
    unsigned stray_ = 0;  // `#,?` fences given up whose answers may still come
    unsigned token_counter_ = 0;
    unsigned lost_fences_ = 0;
    std::uint64_t fence_timeouts_ = 0;
    std::size_t in_flight_ = 0;
    std::deque<Request> waiting_;
    std::deque<Batch> batches_;
};

}  // namespace asip::session
