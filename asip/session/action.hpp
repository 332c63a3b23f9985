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

/// Names one submitted request; not used twice by one session, never 0.
using RequestId = std::uint64_t;
/// A sender of requests; the caller chooses the number. Requests of one client keep their order.
using ClientId = std::uint64_t;
/// Whether an event of the right service and tag can be the answer to a request; one that cannot is damaged.
using AnswerCheck = std::function<bool(const protocol::Event&)>;

/// How a request ended. Each submitted request ends exactly once, not later than its deadline.
enum class Ending {
    /// Its fence came back, and there was no sign of damage since it was sent. Where a value was asked for,
    /// it is in Finished::answer.
    kExecuted,
    /// The same, for a request that asked for no proof.
    kUnproven,
    /// The board refused it: see Finished::code.
    kBoardError,
    /// Sent, but something on the line was lost or damaged meanwhile, or the board restarted: it may or may
    /// not have been executed.
    kDoubt,
    /// Executed, but the value that it asked for did not come.
    kNoValue,
    /// Sent, and no answer in time: it may or may not have been executed.
    kTimeout,
    /// Not sent, and never will be: see Finished::not_sent.
    kNotSent,
};

/// Why a request was not sent.
enum class NotSent {
    kBoardGone,  ///< the link was lost, or the board no longer answers
    kDeadline,   ///< its deadline came before its turn
    kStopped,    ///< BoardSession::cancel_waiting()
};

/// Write these bytes to the link, in order.
struct Write {
    std::string bytes;
};

/// Wait until all that was written has left, set the rate of the link, then call
/// BoardSession::line_rate_set() with whether that succeeded. Nothing is written in between.
struct SetLineRate {
    unsigned baud = 0;
};

/// One complete line from the board that did not answer a question of the session itself.
struct BoardLine {
    protocol::ParsedLine line;
    /// The client whose request this line answers, or whose request it is an error of. Events, and whatever
    /// cannot be attributed to one request, have none and concern everybody.
    std::optional<ClientId> owner;
};

/// The board is known, or known again, and requests are sent. What it is: BoardSession::identity().
struct Identified {
    bool changed = true;  ///< false: the same board with the same services as before
};

/// The board restarted, but the link stayed. Its settings are being restored; an Identified follows.
struct BoardReset {
    std::string why;  ///< how it was noticed, for a log
};

/// The board no longer answers although the link is up. The session continues to ask; requests are refused
/// until the next Identified.
struct BecameSilent {};

/// No question was answered for SessionOptions::patience, at any rate, before the board was known; reported
/// once per link_up. The session continues to ask.
struct NoAnswer {
    bool heard_bytes = false;  ///< something arrived: without a banner a wrong rate, or not an ASIP board
    bool heard_banner = false;
};

/// The line rate in use changed, for logs and descriptions.
struct LineRateChanged {
    unsigned baud = 0;
    std::string why;  ///< for a log
};

/// Bytes that are no message of this protocol were dropped, or an event cannot be the answer that it seems
/// to be.
struct Garbage {
    std::string reason;  ///< for a log
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
