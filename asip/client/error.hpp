#pragma once
#include <string>
#include <string_view>

#include "asip/expected.hpp"

namespace asip::client {

/// Why a call on a board did not succeed. What to do differs by kind; `text` is a sentence for a person.
struct Error {
    enum class Kind {
        Invalid,  ///< The call itself is wrong (no such service, argument out of range); nothing was sent.
        Refused,  ///< Whoever carries the command to the board would not: queue full, command unknown to it.
        Board,    ///< The board answered with an error; `code` is its number (PROTOCOL: 3 INVALID_PIN, ...).
        Timeout,  ///< No answer in time. The command may or may not have been executed.
        Unreachable,  ///< The board, the port or the broker is not there, or went away during the call.
        Closed,       ///< The Board was closed by this program.
    };

    Kind kind = Kind::Closed;
    int code = 0;  ///< With Board the board's error number, else 0.
    std::string text;

    friend bool operator==(const Error&, const Error&) = default;
};

/// "invalid", "refused", "board error 3", ... followed by the text, for a log line.
std::string to_string(const Error& error);

template <class T>
using Result = Expected<T, Error>;

/// `return failure(Error::Kind::Timeout, "...");`
Unexpected<Error> failure(Error::Kind kind, std::string text, int code = 0);

}  // namespace asip::client
