// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "asip/expected.hpp"
#include "asip/protocol/request.hpp"
#include "asip/random.hpp"
#include "asip/session/action.hpp"
#include "asip/session/interview.hpp"
#include "asip/time.hpp"

namespace asip::session {

/// Why submit() did not take a request. Nothing of it was sent.
enum class Refusal {
    /// Not a request line: `S,t[,...]`, printable characters, at most kMaxRequestBytes, and none of `#,B`,
    /// `#,C` and `#,V`, which are the session's own.
    kInvalid,
    /// Longer than Extensions::longest_request() of this board.
    kTooLong,
    /// kMaxQueuedPerClient requests of this client wait already, or kMaxQueued of all clients; of urgent ones
    /// kMaxUrgent.
    kQueueFull,
    /// The link is down, the board is silent, or it was not identified since link_up.
    kNoBoard,
    /// It stores a name on the board, as others did before: see NameBudget.
    kTooManyNames,
};

/// The word of asip/bus/request/reply.hpp: several causes share one.
const char* to_string(Refusal refusal);

/// When lines carry a checksum, on boards that have that extension.
enum class ChecksumPolicy {
    kAuto,    ///< where it costs less than 0.1 ms a line, and from the first sign of damage at any rate
    kAlways,  ///< from the interview on
    kNever,
};

/// How a session behaves; each member has a default that suits real boards.
struct SessionOptions {
    /// Highest line rate to step up to; 0 leaves the rate alone.
    unsigned max_baud = 1'000'000;
    ChecksumPolicy checksum = ChecksumPolicy::kAuto;
    /// A board that sent nothing for this long is probed.
    Duration silence = std::chrono::seconds(2);
    /// A fence or an answer not back after this long is overdue. A 0.4 board waits up to a second inside a
    /// cut-off message.
    Duration answer_timeout = std::chrono::milliseconds(1500);
    /// A board that has sent no byte for this long, and was asked something at least answer_timeout ago, is
    /// gone.
    Duration gone_after = std::chrono::seconds(4);
    /// How long after link_up, or after its last answer, a board that is not known yet may answer nothing
    /// until NoAnswer is reported. An Uno's boot loader takes two seconds. Also how long a board that is
    /// there may answer nothing that can be understood, or restart without answering, until it is gone.
    Duration patience = std::chrono::seconds(8);
};

/// What the link can do, given with link_up.
struct LinkTraits {
    unsigned baud = 0;  ///< the line's rate now; 0 where there is none (TCP)
    /// The board just restarted (the port's DTR line was pulsed): do not write before the banner or 2.5 s.
    bool restarting = false;
};

/// Deadline of a request whose sender gives none.
inline constexpr Duration kDefaultDeadline = std::chrono::seconds(5);
/// How long after its execution the value that a request asks for may come, unless the sender knows better.
inline constexpr Duration kDefaultAnswerTime = std::chrono::seconds(1);

struct RequestOptions {
    /// Its sender. Clients are served in turn; of one client each request comes after the one before.
    ClientId client = 0;
    /// It ends at this time at the latest, and is not sent later. None: kDefaultDeadline from now.
    std::optional<Time> deadline{};
    /// Whether its execution must be proven. Requests without cost no fence of their own.
    bool prove = true;
    /// Tag of the event that answers this request, of the same service; 0 if none is expected. The request
    /// then ends when that event has come, even where the board executes it sooner. While the board also
    /// sends such events by itself, only one behind the fence counts.
    char answer_tag = 0;
    /// How long after its execution that event may come.
    Duration answer_time = kDefaultAnswerTime;
    /// It is sent before all other requests that wait, and while the answer to a fence is overdue, too. Where
    /// its execution could then not be told from a lost line, it ends in kDoubt.
    bool urgent = false;
    /// Called with each event that comes while this request waits for its answer. Where it says no, all that
    /// is under way ends in kDoubt. None: each event is believed. The session itself checks the answers to
    /// questions of the protocol.
    AnswerCheck is_answer{};
};

/// Counted since construction.
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

/// kAtOnce: whatever is under way; its end, and the board's answer, are not waited for.
enum class Leave { kOnceQuiet, kAtOnce };

class Machine;

/// One ASIP board behind a byte stream, of either firmware generation: finds out what it is, paces requests
/// so that its 64-byte receive buffer cannot overrun, proves their execution with fences, steps the line up,
/// notices restarts, damage and silence, and restores what clients had set (pin modes and periods, never
/// output values).
///
/// Pure: it reads no clock and does no input or output. Each call appends what the caller has to do, in
/// order. The caller performs it, calls tick() when next_deadline() has come, and passes times that do not go
/// back. Randomness is drawn while constructing only. One thread at a time.
class BoardSession {
  public:
    /// Never more than this is on its way to the board and not proven to be read.
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

    /// The link is open: the board is looked for and asked what it is.
    void link_up(const LinkTraits& traits, Time now, Actions& out);
    /// Everything in flight times out, everything that waits is not sent. What clients had set is kept for
    /// the next link_up.
    void link_down(Time now, Actions& out);
    /// Bytes from the board, any number, cut anywhere. Ignored while the link is down.
    void receive(std::string_view bytes, Time now, Actions& out);
    /// The port is about to be closed: what waits is not sent, checksums end, and the line returns to the
    /// rate that it had at link_up, as the next program expects it. Takes a third of a second at most; the
    /// state is kDown then.
    void leave(Leave how, Time now, Actions& out);
    /// Time has passed. May be called at any time; must be called when next_deadline() has come.
    void tick(Time now, Actions& out);
    /// The caller was stopped, and listened to nothing from `since` to `now`. Before any other call behind
    /// it.
    void not_watched(Time since, Time now);
    /// The answer to SetLineRate: `ok` if the link now has that rate.
    void line_rate_set(bool ok, Time now, Actions& out);

    /// Queues one request line (line end optional). While the board restarts or is identified again, requests
    /// wait, each until its deadline. The Finished of the request may already be among `out`.
    Expected<RequestId, Refusal> submit(std::string_view line, const RequestOptions& options, Time now,
                                        Actions& out);
    /// The same for a line that was parsed already.
    Expected<RequestId, Refusal> submit(const protocol::Request& request, const RequestOptions& options,
                                        Time now, Actions& out);
    /// Ends every request that waits and is not urgent, with kNotSent. Their number.
    std::size_t cancel_waiting(Actions& out);
    /// Whether submit() would not refuse a request with kNoBoard.
    bool accepts_requests() const;
    /// How many more requests of this client may be queued now, and how many wait.
    std::size_t room(ClientId client) const;
    /// How many requests that store a name on the board would be accepted now.
    unsigned names_left(Time now) const;
    std::size_t waiting(ClientId client) const;

    /// When tick() wants to be called; none while the link is down.
    std::optional<Time> next_deadline() const;

    State state() const;
    /// Valid from the first Identified on; kept while the board is away.
    const Identity& identity() const;
    /// The line's rate now; 0 on TCP.
    unsigned baud() const;
    /// What may be in the board's receive buffer; never above kReceiveBufferBytes.
    std::size_t bytes_in_flight() const;
    /// Requests that wait to be sent, of all clients and of the session itself.
    std::size_t queued() const;
    /// Whether lines carry checksums now.
    bool checksums() const;
    const SessionCounters& counters() const;
    /// Auto-event period in ms that a client set for a service and that is in force; none if unknown.
    std::optional<unsigned> period(char service) const;

  private:
    std::unique_ptr<Machine> machine_;
};

/// Whether submit() would not refuse this request with kInvalid.
bool may_be_sent(const protocol::Request& request);

/// For logs.
const char* to_string(BoardSession::State state);
const char* to_string(Ending ending);

}  // namespace asip::session
