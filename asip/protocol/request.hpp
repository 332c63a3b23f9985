// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "asip/protocol/pin.hpp"

namespace asip::protocol {

// Request lines, all without a newline. Builders do not check their arguments; the board does.

// Questions: the board answers each with an event of the same service and tag, as board_info.hpp reads it.

inline constexpr std::string_view kAskInfo = "#,?";
inline constexpr std::string_view kAskServiceNames = "#,N";
inline constexpr std::string_view kAskPinOwners = "#,S";
inline constexpr std::string_view kAskExtensions = "#,X";
inline constexpr std::string_view kAskIdentity = "#,I";
inline constexpr std::string_view kAskPortMap = "I,M";
inline constexpr std::string_view kAskAnalogMap = "I,m";
inline constexpr std::string_view kAskPinModes = "I,p";
inline constexpr std::string_view kAskPinCapabilities = "I,c";
inline constexpr std::string_view kAskLevels = "I,L";  ///< of boards with the extension kLevels

/// Resets every service of the board and turns all auto-events off; has no answer.
inline constexpr std::string_view kRestart = "#,R";

/// make_request('S', 'W', {0, 90}) -> "S,W,0,90".
std::string make_request(char service, char tag, std::initializer_list<int> parameters = {});
/// `mode` is one of is_settable().
std::string set_pin_mode(int pin, PinMode mode);
std::string digital_write(int pin, bool high);
/// `value`: 0 to 255, the duty of a PWM pin.
std::string analog_write(int pin, int value);
/// How often analog inputs are reported: 1 to 65535; 0 stops them.
std::string analog_period(int milliseconds);
/// `token`: 1 to 8 letters or digits, which come back. Boards with the echo extension only.
std::string echo(std::string_view token);
/// The same as echo(), for boards with the extension of verified fences: a digest comes behind the token.
std::string verified_fence(std::string_view token);
/// `name`: at most 32 characters, kept in EEPROM. Boards with the identity extension only.
std::string set_identity(std::string_view name);
/// Boards with the line-rate extension only. The board answers at the old rate and then changes.
std::string set_line_rate(int baud);
/// Boards with the checksum extension only.
std::string set_checksum(bool on);

/// A request `S,t[,params]` taken apart. `line` and `parameters` are views into the text that was parsed.
struct Request {
    std::string_view line;  ///< the whole request, without line end
    char service;
    char tag;
    std::string_view parameters;  ///< without the comma before them; may be empty
};

/// Fails when the line is longer than kMaxRequestBytes, holds anything but printable ASCII, or is not a
/// request. A trailing line end is not allowed here; split_requests takes it off.
Expected<Request> parse_request(std::string_view line);

/// Each of them ends a request, and so do both together.
inline constexpr std::string_view kRequestEnds = "\r\n";

/// How many characters at the beginning boards skip: blanks, zeros and control characters.
std::size_t ignored_before(std::string_view text);

/// What a board reads of a line without its end: none of these characters at its beginning, nor at its end.
/// Empty for a line that boards ignore: one of them alone, and debug text, which begins with `!`.
std::string_view significant(std::string_view line);

/// Takes a control payload apart into requests, each of a line as significant() gives it: kRequestEnds
/// between them, optional at the end; lines that boards ignore are skipped. Fails as a whole, with the
/// reason, for one line that parse_request() refuses, and for more than kMaxRequestsPerPayload lines. The
/// views point into the payload.
Expected<std::vector<Request>> split_requests(std::string_view payload);

/// The lines of a control payload that boards do not ignore, before anything else is known of them.
struct PayloadLines {
    std::size_t count = 0;
    std::string_view first{};
};
PayloadLines lines_of(std::string_view payload);

}  // namespace asip::protocol
