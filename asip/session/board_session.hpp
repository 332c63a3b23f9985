#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "asip/expected.hpp"
#include "asip/session/action.hpp"
#include "asip/session/identity.hpp"
#include "asip/time.hpp"

namespace asip::session {

struct SessionOptions {
    /// Highest line rate to step up to; 0 leaves the rate alone.
    unsigned max_baud = 1'000'000;
    /// Turn the checksum extension on where the board has it. Costs 3 bytes a line and one request in flight
    /// at a time.
    bool checksum = false;
    /// Probe a board that said nothing for this long.
    Duration silence = std::chrono::seconds(2);
    /// A fence or an answer not back after this long is lost. A 0.4 board waits up to a second inside a
    /// cut-off message.
    Duration answer_timeout = std::chrono::milliseconds(1500);
    /// How long after link_up without any answer until NoAnswer is said. An Uno's boot loader takes two
    /// seconds.
    Duration patience = std::chrono::seconds(8);
};

/// What the link can do, said with link_up.
struct LinkTraits {
    unsigned baud = 0;  ///< the line's rate now; 0 where there is none (TCP)
    /// The board just restarted (the port's DTR line was pulsed): do not write before the banner or 2.5 s.
    bool restarting = false;
};

struct RequestOptions {
    /// Whether the end must say what it proves. Requests without cost no fence of their own.
    bool prove = true;
    /// Tag of the event that answers this request, of the same service; 0 if none is expected.
    char answer_tag = 0;
};

enum class Refusal {
    kInvalid,  ///< not a request line: `S,t[,...]`, printable characters, at most 62 bytes, and neither `#,B`
               ///< nor `#,C`
    kQueueFull,  ///< BoardSession::kMaxQueued requests wait already
    kNoBoard,    ///< link down, silent, or nobody identified yet
};

struct SessionCounters {
    std::uint64_t lines_in = 0;
    std::uint64_t bytes_in = 0;
    std::uint64_t bytes_out = 0;
    std::uint64_t garbage = 0;
    std::uint64_t resets = 0;
    std::uint64_t fence_timeouts = 0;
    std::uint64_t checksum_errors = 0;
};

/// One ASIP board behind a byte stream, of either firmware generation: finds out what it is, paces requests
/// so that its 64-byte receive buffer cannot overrun, proves their execution with fences, steps the line up,
/// notices restarts and restores what clients had set (pin modes and periods, never output values), notices
/// silence.
///
/// Pure: it reads no clock and does no input or output. Each call appends what the caller has to do, in
/// order. The caller calls tick() when next_deadline() has come, and each call with a time not before the one
/// of the call before.
class BoardSession {
  public:
    static constexpr std::size_t kMaxInFlightBytes = 48;
    static constexpr std::size_t kMaxQueued = 512;

    enum class State { kDown, kSearching, kIdentifying, kReady, kSilent };

    explicit BoardSession(SessionOptions options = {});
    ~BoardSession();
    BoardSession(BoardSession&&) noexcept;
    BoardSession& operator=(BoardSession&&) noexcept;

    void link_up(const LinkTraits& traits, Time now, Actions& out);
    /// Everything in flight times out, everything queued is not sent. What clients had set is kept for the
    /// next link_up.
    void link_down(Time now, Actions& out);
    void receive(std::string_view bytes, Time now, Actions& out);
    void tick(Time now, Actions& out);
    /// The answer to SetLineRate.
    void line_rate_set(bool ok, Time now, Actions& out);

    /// Queues one request line (line end optional). While the board restarts or is identified again, requests
    /// wait.
    Expected<RequestId, Refusal> submit(std::string_view line, const RequestOptions& request, Time now,
                                        Actions& out);

    /// When tick() wants to be called; none while the link is down.
    std::optional<Time> next_deadline() const;

    State state() const;
    /// Valid since the first Identified; kept while the board is away.
    const Identity& identity() const;
    /// The line's rate now; 0 on TCP.
    unsigned baud() const;
    /// What was sent and not yet proven, in bytes; never above kMaxInFlightBytes but for one longer request
    /// alone.
    std::size_t bytes_in_flight() const;
    std::size_t queued() const;
    const SessionCounters& counters() const;
    /// Auto-event period in ms that a client set for a service and that is in force; none if unknown.
    std::optional<unsigned> period(char service) const;

  private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

/// For logs.
const char* to_string(BoardSession::State state);
const char* to_string(Refusal refusal);
const char* to_string(Ending ending);

}  // namespace asip::session
