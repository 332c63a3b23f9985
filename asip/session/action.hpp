#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "asip/protocol/parsed_line.hpp"

namespace asip::session {

using RequestId = std::uint64_t;
/// Whoever sends requests; chosen by the caller. Requests of one client keep their order.
using ClientId = std::uint64_t;

/// How a request ended. Each submitted request ends exactly once, not later than its deadline.
enum class Ending {
    kExecuted,    ///< its fence came back, and there was no sign of damage since it was sent; where a value
                  ///< was asked for, it is in `answer`
    kUnproven,    ///< the same, for a request that asked for no proof
    kBoardError,  ///< the board refused it: see `code`
    kDoubt,       ///< sent, but something on the line was lost or damaged meanwhile, or the board restarted:
                  ///< it may or may not have been executed
    kNoValue,     ///< executed, but the value it asked for did not come
    kTimeout,     ///< sent, and no answer in time: it may or may not have been executed
    kNotSent,     ///< not sent, and never will be: see `not_sent`
};

/// Why a request was not sent.
enum class NotSent {
    kBoardGone,  ///< the link went, or the board fell silent
    kDeadline,   ///< its deadline came first
    kStopped,    ///< BoardSession::cancel_waiting()
};

/// Write these bytes to the link, in order.
struct Write {
    std::string bytes;
};

/// Drain what was written, then set the link's rate, then call BoardSession::line_rate_set().
struct SetLineRate {
    unsigned baud = 0;
};

/// One complete line from the board that did not answer a question of the session itself.
struct BoardLine {
    protocol::ParsedLine line;
    /// Set where the line is an error or an answer that belongs to one request: the client that sent it.
    /// Events, and whatever cannot be attributed, have none.
    std::optional<ClientId> owner;
};

/// The board is known (again) and requests are sent. What it is: BoardSession::identity().
struct Identified {
    bool changed = true;  ///< false: the same board with the same services as before
};

/// The board restarted by itself. Settings are being restored; an Identified follows.
struct BoardReset {
    std::string why;
};

/// The board no longer answers although the link is up. The session goes on asking; requests are refused
/// until the next Identified.
struct BecameSilent {};

/// Nothing that speaks ASIP answered since link_up, at any rate; reported once per link_up. The session goes
/// on asking.
struct NoAnswer {
    bool heard_bytes = false;  ///< something arrived, but no ASIP: a wrong rate or not an ASIP board
};

/// The line rate in use changed; reported after link_up's rate was left and whenever it is left again.
struct LineRateChanged {
    unsigned baud = 0;
    std::string why;
};

/// Bytes that are no message of this protocol were dropped.
struct Garbage {
    std::string reason;
    std::string sample;  ///< the first bytes, at most 32, unprintable ones replaced by '?'
};

/// A submitted request ended.
struct Finished {
    RequestId id = 0;
    Ending ending = Ending::kTimeout;
    NotSent not_sent = NotSent::kBoardGone;  ///< kNotSent only
    int code = 0;                            ///< kBoardError: the board's error number
    std::string text;                        ///< kBoardError: the board's words
    protocol::ParsedLine answer;             ///< the event that answers the request; empty where none came
};

using Action = std::variant<Write, SetLineRate, BoardLine, Identified, BoardReset, BecameSilent, NoAnswer,
                            LineRateChanged, Garbage, Finished>;
using Actions = std::vector<Action>;

}  // namespace asip::session
