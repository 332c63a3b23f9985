// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "asip/protocol/message.hpp"

namespace asip::session {

// What a BoardSession gives its caller: what it has to do, and what it has to know. Values that own their
// texts.

/// Not used twice by one session, never 0.
using RequestId = std::uint64_t;
/// A sender of requests, numbered by the caller. Requests of one client keep their order.
using ClientId = std::uint64_t;
/// Whether an event of the right service and tag can be the answer; else it is damaged.
using AnswerCheck = std::function<bool(const protocol::Event&)>;

/// How a request ended. Each request ends exactly once, by its deadline.
enum class Ending {
    /// Its fence came back without a sign of damage. Finished::answer holds the value, if one was asked for.
    kExecuted,
    /// The same, without proof.
    kUnproven,
    /// The board refused it: see Finished::code.
    kBoardError,
    /// Something was lost or damaged meanwhile, or the board restarted: it may or may not have been executed.
    kDoubt,
    /// Executed, but its value did not come.
    kNoValue,
    /// No answer in time: it may or may not have been executed.
    kTimeout,
    /// It never will be sent: see Finished::not_sent.
    kNotSent,
};

enum class NotSent {
    kBoardGone,  ///< the link was lost, or the board no longer answers
    kDeadline,   ///< its deadline came before its turn
    kStopped,    ///< BoardSession::cancel_waiting()
};

struct Write {
    std::string bytes;
};

/// When all that was written has left, set the rate of the link, then call BoardSession::line_rate_set().
/// Nothing is written in between.
struct SetLineRate {
    unsigned baud = 0;
};

/// A line from the board that answers no question of the session itself.
struct BoardLine {
    protocol::ParsedLine line;
    /// The client whose request this line answers or refuses. Events and unattributed lines have none: they
    /// concern all.
    std::optional<ClientId> owner;
};

/// The board is known (again) and requests are sent: BoardSession::identity().
struct Identified {
    bool changed = true;  ///< false: the same board with the same services as before
};

/// The board restarted. Its settings are being restored; an Identified follows.
struct BoardReset {
    std::string why;  ///< how it was noticed, for a log
};

/// The board no longer answers. The session asks on; requests are refused until the next Identified.
struct BecameSilent {};

/// No question was answered for SessionOptions::patience, before the board was known; once per link_up. The
/// session asks on.
struct NoAnswer {
    bool heard_bytes = false;  ///< something arrived: without a banner a wrong rate, or not an ASIP board
    bool heard_banner = false;
};

/// For logs and descriptions.
struct LineRateChanged {
    unsigned baud = 0;
    std::string why;  ///< for a log
};

/// Bytes were dropped that are no message, or an event cannot be the answer that it seems to be.
struct Garbage {
    std::string reason;  ///< for a log
    std::string sample;  ///< the first bytes, at most 32, unprintable ones replaced by '?'
};

/// The board executed a request of the session itself that writes an output's level of before its restart.
struct LevelRestored {
    std::string line;
};

struct Finished {
    RequestId id = 0;
    Ending ending = Ending::kTimeout;
    NotSent not_sent = NotSent::kBoardGone;  ///< kNotSent only
    int code = 0;                            ///< kBoardError: the board's error number
    std::string text;                        ///< kBoardError: the board's words
    protocol::ParsedLine answer;             ///< the event that answers the request; empty where none came
};

using Action = std::variant<Write, SetLineRate, BoardLine, Identified, BoardReset, BecameSilent, NoAnswer,
                            LineRateChanged, Garbage, LevelRestored, Finished>;
using Actions = std::vector<Action>;

}  // namespace asip::session
