// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>
#include <variant>

namespace asip::protocol {

// What one line from a board means. All views point into the line that was parsed and are valid as long as
// it; ParsedLine keeps both.

/// `@S,t,BODY`: an answer or an auto-event. The body may be empty.
struct Event {
    char service;  ///< its letter, or `#` for the system
    char tag;
    std::string_view body;  ///< see body.hpp and the service's model
};

/// `~S,t,NUMBER{TEXT}`. See error_code.hpp for the numbers; others are possible.
struct ErrorReply {
    char service;
    char tag;
    int code;               ///< 0 or more
    std::string_view text;  ///< between the braces; may be empty
};

/// `!TEXT`: banner or debug text, without the `!`.
struct Info {
    std::string_view text;
};

/// Anything else: a damaged line, or a board that does not speak ASIP. `reason` has static storage and says
/// for a log what is wrong.
struct Malformed {
    std::string_view reason;
};

using Message = std::variant<Event, ErrorReply, Info, Malformed>;

/// Parses one line without its line end. Never fails otherwise than by Malformed. Bytes outside printable
/// ASCII make an event or error Malformed (a damaged line), and are let through in Info. Where people named
/// something (the sketch in `@#,?`, services in `@#,N`, the words of an error) bytes beyond ASCII pass.
Message parse_line(std::string_view line);

}  // namespace asip::protocol
