// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
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

/// The number in a board's error `~S,t,NUMBER{TEXT}`. Firmware of others may send numbers that are not listed
/// here, so an error is kept as an int and this is used to compare with.
enum class ErrorCode : int {
    kNoError = 0,
    kInvalidService = 1,
    kUnknownRequest = 2,
    kInvalidPin = 3,
    kModeUnavailable = 4,
    kInvalidMode = 5,
    kWrongMode = 6,
    kInvalidDeviceNumber = 7,
    kDeviceNotAvailable = 8,
    kI2cNotEnabled = 9,
    kBadChecksum = 10,  ///< extension C
    kBadArgument = 11,  ///< boards with extensions; in 0.4 the request is dropped or answered at random
};

/// The text that stands in the braces on the wire, such as "INVALID_DEVICE_NUMBER"; "UNKNOWN_ERROR" for
/// numbers that have none. Static storage.
std::string_view error_name(int code);
inline std::string_view error_name(ErrorCode code) {
    return error_name(static_cast<int>(code));
}

/// One line from a board together with what parse_line() found in it. It owns its text, so that it can be
/// kept and passed on without parsing the line again. Copies and moves are independent of each other.
class ParsedLine {
  public:
    ParsedLine() = default;
    /// Parses `line`, which has no line end.
    explicit ParsedLine(std::string line);
    /// `message` is what parse_line(line) returned for this very `line`.
    ParsedLine(std::string_view line, const Message& message);

    /// The whole line.
    const std::string& text() const { return text_; }
    bool empty() const { return text_.empty(); }

    // Info and malformed lines are neither.
    bool is_event() const { return kind_ == Kind::kEvent; }
    bool is_error() const { return kind_ == Kind::kError; }

    /// The views in these point into text() and are valid as long as this line is neither changed, moved nor
    /// destroyed. Call each only where the line is of that kind.
    Event event() const { return {service_, tag_, std::string_view(text_).substr(part_at_, part_size_)}; }
    ErrorReply error() const {
        return {service_, tag_, code_, std::string_view(text_).substr(part_at_, part_size_)};
    }

  private:
    enum class Kind : unsigned char { kOther, kEvent, kError };

    void keep(const Message& message, std::string_view line);

    std::string text_;
    Kind kind_ = Kind::kOther;
    char service_ = 0;
    char tag_ = 0;
    int code_ = 0;
    std::size_t part_at_ = 0;  // the event's body, or the error's text
    std::size_t part_size_ = 0;
};

}  // namespace asip::protocol
