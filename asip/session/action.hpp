#pragma once
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace asip::session {

using RequestId = std::uint64_t;

/// How a request ended. Each submitted request ends exactly once.
enum class Ending {
    kExecuted,    ///< a fence sent behind it came back with no error between: the board executed it
    kUnproven,    ///< sent, and no proof was asked for; the board said no error so far
    kBoardError,  ///< the board refused it: see `code`
    kTimeout,     ///< sent, and its fence never came back: it may or may not have been executed
    kNotSent,     ///< the link went, or the board fell silent, before it was sent: not executed
};

/// Put these bytes on the link, in order.
struct Write {
    std::string bytes;
};

/// Drain what was written, then set the link's rate, then call BoardSession::line_rate_set().
struct SetLineRate {
    unsigned baud = 0;
};

/// One complete line from the board that was not an answer to the session's own questions, without its line
/// end. It begins with '@', '~' or '!'.
struct BoardLine {
    std::string line;
};

/// The board is known (again) and takes requests. What it is: BoardSession::identity().
struct Identified {
    bool changed = true;  ///< false: the same board with the same services as before
};

/// The board restarted by itself. Settings are being restored; an Identified follows.
struct BoardReset {
    std::string why;
};

/// The board no longer answers although the link is up. The session goes on asking.
struct BecameSilent {};

/// Nothing that speaks ASIP answered since link_up, at any rate; said once per link_up. The session goes on
/// asking.
struct NoAnswer {
    bool heard_bytes = false;  ///< something arrived, but no ASIP: a wrong rate or not an ASIP board
};

/// The line rate in use changed; said after link_up's rate was left and whenever it is left again.
struct LineRateChanged {
    unsigned baud = 0;
    std::string why;
};

/// Bytes that are no message of this protocol were dropped.
struct Garbage {
    std::string reason;
    std::string sample;  ///< the first bytes, at most 32, not printable ones replaced by '?'
};

/// A submitted request ended.
struct Finished {
    RequestId id = 0;
    Ending ending = Ending::kTimeout;
    int code = 0;        ///< kBoardError: the board's error number
    std::string text;    ///< kBoardError: the board's words
    std::string answer;  ///< the board's event that answers the request, if one was expected and came
};

using Action = std::variant<Write, SetLineRate, BoardLine, Identified, BoardReset, BecameSilent, NoAnswer,
                            LineRateChanged, Garbage, Finished>;
using Actions = std::vector<Action>;

}  // namespace asip::session
