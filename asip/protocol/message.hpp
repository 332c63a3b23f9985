#pragma once
#include <string_view>
#include <variant>

namespace asip::protocol {

// What one line from a board says. All views point into the line that was parsed.

/// `@S,t,BODY`: an answer or an auto-event. The body may be empty.
struct Event {
    char service;
    char tag;
    std::string_view body;
};

/// `~S,t,NUMBER{TEXT}`. See error_code.hpp for the numbers; others are possible.
struct ErrorReply {
    char service;
    char tag;
    int code;
    std::string_view text;
};

/// `!TEXT`: banner or debug text, without the `!`.
struct Info {
    std::string_view text;
};

/// Anything else. `reason` has static storage.
struct Malformed {
    std::string_view reason;
};

using Message = std::variant<Event, ErrorReply, Info, Malformed>;

/// Parses one line without its line end. Never fails otherwise than by Malformed. Bytes outside printable
/// ASCII make an event or error Malformed (a damaged line), and are let through in Info.
Message parse_line(std::string_view line);

}  // namespace asip::protocol
