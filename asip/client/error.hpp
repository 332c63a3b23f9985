// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "asip/expected.hpp"

namespace asip::client {

/// Why a call on a board did not succeed. What to do differs by kind; `text` is a sentence for a person.
struct Error {
    enum class Kind {
        /// The call itself is wrong (no such service, an argument out of range); nothing was sent.
        kInvalid,
        /// The agent refused the command (its queue is full, it does not know it); the board did not get it.
        kRefused,
        /// The board answered with an error; `code` is its number.
        kBoard,
        /// No answer in time. The command may or may not have been executed.
        kTimeout,
        /// The board, the port or the broker is not there, or went away during the call.
        kUnreachable,
        /// The Board was closed by this program.
        kClosed,
    };

    Kind kind = Kind::kClosed;
    int code = 0;      ///< kBoard: the board's error number, see protocol::ErrorCode; else 0
    std::string text;  ///< a sentence for a person

    friend bool operator==(const Error&, const Error&) = default;
};

/// "invalid", "refused", "board error 3", ... followed by the text, for a log line.
std::string to_string(const Error& error);

template <class T>
using Result = Expected<T, Error>;

/// Makes the failed result: `return failure(Error::Kind::kTimeout, "...");`
Unexpected<Error> failure(Error::Kind kind, std::string text, int code = 0);

}  // namespace asip::client
