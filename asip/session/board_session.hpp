// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "asip/protocol/request.hpp"
#include "asip/random.hpp"
#include "asip/session/action.hpp"
#include "asip/session/interview.hpp"
#include "asip/time.hpp"

namespace asip::session {

/// Why submit() took nothing of a request.
enum class Refusal {
    /// Not a request line: `S,t[,...]`, printable characters, at most kMaxRequestBytes, and none of `#,B`,
    /// `#,C` and `#,V`, which are the session's own.
    kInvalid,
    /// Longer than Extensions::longest_request() of this board.
    kTooLong,
    /// kMaxQueuedPerClient requests of this client wait already, kMaxQueued of all clients, or kMaxUrgent.
    kQueueFull,
    /// The link is down, the board silent, or not identified since link_up.
    kNoBoard,
    /// It stores a name on the board: see NameBudget.
    kTooManyNames,
};

/// The word of asip/bus/request/reply.hpp; several causes share one.
const char* to_string(Refusal refusal);

/// When lines carry a checksum, where the board has that extension.
enum class ChecksumPolicy {
    kAuto,    ///< where it costs less than 0.1 ms a line, and from the first sign of damage at any rate
    kAlways,  ///< from the interview on
    kNever,
};

/// The defaults suit real boards.
struct SessionOptions {
    /// The rate to step up to at most; 0: the line keeps its rate.
    unsigned max_baud = 1'000'000;
    /// A rate is set by opening the port anew, which restarts many boards: those, as their banner shows, keep
    /// the start rate, and all are given time there.
    bool opens_for_rate = false;
    ChecksumPolicy checksum = ChecksumPolicy::kAuto;
    /// After it the board is probed.
    Duration silence = std::chrono::seconds(2);
    /// After it a fence or an answer is overdue: a 0.4 board waits up to a second inside a cut-off message.
    Duration answer_timeout = std::chrono::milliseconds(1500);
    /// A board is gone that sent no byte for so long, and was asked at least answer_timeout ago.
    Duration gone_after = std::chrono::seconds(4);
    /// How long an unknown board may answer nothing until NoAnswer is reported (an Uno's boot loader takes
    /// two seconds), and how long a known one may answer nothing that can be understood until it is gone.
    Duration patience = std::chrono::seconds(8);
};

struct LinkTraits {
    unsigned baud = 0;  ///< the line's rate now; 0 where there is none (TCP)
    /// The port's DTR line just restarted the board: nothing is written before the banner or 2.5 s.
    bool restarting = false;
    bool perhaps_another_board = false;  ///< nothing that was set before is set again
};

/// Where the sender gives none.
inline constexpr Duration kDefaultDeadline = std::chrono::seconds(5);
/// How long the value that a request asks for may come behind its execution, by default.
inline constexpr Duration kDefaultAnswerTime = std::chrono::seconds(1);

struct RequestOptions {
    /// Clients are served in turn; requests of one client keep their order.
    ClientId client = 0;
    /// It ends by then, and is not sent later. None: kDefaultDeadline from now.
    std::optional<Time> deadline{};
    /// Its execution must be proven. Requests without cost no fence of their own.
    bool prove = true;
    /// Tag of the event of the same service that answers this request, and ends it; 0: none does. While the
    /// board also sends such events by itself, only one behind the fence counts.
    char answer_tag = 0;
    /// How long behind the execution that event may come.
    Duration answer_time = kDefaultAnswerTime;
    /// It goes ahead of all others, also while a fence is overdue. Where its execution then could not be told
    /// from a lost line, it ends in kDoubt.
    bool urgent = false;
    /// The next request of this client belongs to it: no other client's request for the same service comes
    /// between them. Until the deadline of this one.
    bool more_follow = false;
    /// Asked of each event that comes while this request waits for its answer: a no ends all that is under
    /// way in kDoubt. None: each event is believed. The session itself checks answers to questions of the
    /// protocol.
    AnswerCheck is_answer{};
};

/// Since construction.
struct SessionCounters {
    std::uint64_t lines_in = 0;  ///< complete lines, understood or not
    std::uint64_t bytes_in = 0;
    std::uint64_t bytes_out = 0;
    std::uint64_t garbage = 0;             ///< lines and pieces that are no message or no answer, see Garbage
    std::uint64_t resets = 0;              ///< restarts of the board that were noticed
    std::uint64_t fence_timeouts = 0;      ///< fences that did not come back in time
    std::uint64_t checksum_errors = 0;     ///< received lines whose checksum is wrong or missing
    std::uint64_t unexplained_errors = 0;  ///< errors of the board that belong to no request
    std::uint64_t contradictions = 0;      ///< fences by which the board said that it read something else
};

/// kAtOnce: nothing under way, and no answer, is waited for.
enum class Leave { kOnceQuiet, kAtOnce };

class Machine;

/// One ASIP board behind a byte stream: finds out what it is, paces requests so that its 64-byte receive
/// buffer cannot overrun, proves their execution with fences, steps the line up, notices restarts, damage and
/// silence, and restores pin modes, levels of output pins and periods, nothing else that was set.
/// Pure. The caller performs what each call appends, in order, calls tick() when next_deadline() has come,
/// and passes times that do not go back. Randomness is drawn while constructing only. One thread at a time.
class BoardSession {
  public:
    /// On the way to the board and not proven to be read, at most.
    static constexpr std::size_t kReceiveBufferBytes = 63;
    /// How many requests may wait, of one client and of all.
    static constexpr std::size_t kMaxQueuedPerClient = 64;
    static constexpr std::size_t kMaxQueued = 4096;
    static constexpr std::size_t kMaxUrgent = 1024;

    /// kSilent: the board was gone, and is looked for.
    enum class State { kDown, kSearching, kIdentifying, kReady, kSilent };

    explicit BoardSession(SessionOptions options = {}, const Random& random = system_random());
    ~BoardSession();
    BoardSession(BoardSession&&) noexcept;
    BoardSession& operator=(BoardSession&&) noexcept;

    void link_up(const LinkTraits& traits, Time now, Actions& out);
    /// Everything in flight times out, what waits is not sent. What clients had set is kept for the next
    /// link_up.
    void link_down(Time now, Actions& out);
    /// Any number of bytes, cut anywhere. Ignored while the link is down.
    void receive(std::string_view bytes, Time now, Actions& out);
    /// The port is about to be closed: what waits is not sent, checksums end, and the line returns to its
    /// rate at link_up. Takes a third of a second at most; the state is kDown then.
    void leave(Leave how, Time now, Actions& out);
    /// Must be called when next_deadline() has come; may be called at any time.
    void tick(Time now, Actions& out);
    /// The caller listened to nothing from `since` to `now`. Comes before any other call.
    void not_watched(Time since, Time now);
    /// The answer to SetLineRate.
    void line_rate_set(bool ok, Time now, Actions& out);

    /// Queues a request line (line end optional). While the board restarts, requests wait until their
    /// deadlines. The request's Finished may already be among `out`.
    Expected<RequestId, Refusal> submit(std::string_view line, const RequestOptions& options, Time now,
                                        Actions& out);
    Expected<RequestId, Refusal> submit(const protocol::Request& request, const RequestOptions& options,
                                        Time now, Actions& out);
    /// Ends what waits and is not urgent, with kNotSent. Returns the number.
    std::size_t cancel_waiting(Actions& out);
    /// While on, no pin is made an output that a restart made none; then that is made good.
    void hold_outputs(bool hold);
    /// This request is sent again and again until it is executed: nothing of before is restored in its place.
    void will_execute(std::string_view line);
    /// Requests that write the levels of output pins, as they would be restored.
    std::vector<std::string> levels() const;
    /// submit() refuses nothing with kNoBoard.
    bool accepts_requests() const;
    /// How many more requests of this client may be queued, and how many wait.
    std::size_t room(ClientId client) const;
    /// How many requests that store a name would be accepted now.
    unsigned names_left(Time now) const;
    std::size_t waiting(ClientId client) const;

    /// When tick() wants to be called; none while the link is down.
    std::optional<Time> next_deadline() const;

    State state() const;
    /// Valid from the first Identified on; kept while the board is away.
    const Identity& identity() const;
    /// 0 on TCP.
    unsigned baud() const;
    /// In the board's receive buffer, never above kReceiveBufferBytes.
    std::size_t bytes_in_flight() const;
    /// Those of all clients, and of the session itself.
    std::size_t queued() const;
    bool checksums() const;
    const SessionCounters& counters() const;
    /// The period in ms of a service's events that a client set and that is in force; none: unknown.
    std::optional<unsigned> period(char service) const;

  private:
    std::unique_ptr<Machine> machine_;
};

/// submit() does not refuse it with kInvalid.
bool may_be_sent(const protocol::Request& request);

const char* to_string(BoardSession::State state);

}  // namespace asip::session
