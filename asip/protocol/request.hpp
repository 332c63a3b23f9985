// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <initializer_list>
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

/// Resets every service and turns auto-events off; has no answer.
inline constexpr std::string_view kRestart = "#,R";

/// make_request('S', 'W', {0, 90}) -> "S,W,0,90".
std::string make_request(char service, char tag, std::initializer_list<int> parameters = {});
/// `mode`: is_settable().
std::string set_pin_mode(int pin, PinMode mode);
std::string digital_write(int pin, bool high);
/// `value`: 0 to 255, the duty of a PWM pin.
std::string analog_write(int pin, int value);
/// `token`: 1 to 8 letters or digits, which come back. For the echo extension.
std::string echo(std::string_view token);
/// For verified fences: a digest comes behind the token.
std::string verified_fence(std::string_view token);
/// For the line-rate extension. The answer comes at the old rate.
std::string set_line_rate(int baud);
/// For the checksum extension.
std::string set_checksum(bool on);

/// `S,t[,params]`; views into the parsed text.
struct Request {
    std::string_view line;  ///< the whole request, without line end
    char service;
    char tag;
    std::string_view parameters;  ///< without the comma before them; may be empty
};

/// Fails on more than kMaxRequestBytes, anything but printable ASCII (a line end, too), and what is no
/// request.
Expected<Request> parse_request(std::string_view line);

/// Each ends a request, and both together.
inline constexpr std::string_view kRequestEnds = "\r\n";

/// Characters that boards skip at the beginning: blanks, zeros and control characters.
std::size_t ignored_before(std::string_view text);

/// A line as boards read it, without skipped characters at both ends; empty for lines that they ignore: a
/// lone character, and debug text behind `!`.
std::string_view significant(std::string_view line);

/// Requests of a control payload, as significant() gives them, between kRequestEnds; ignored lines are
/// skipped. Fails as a whole for one that parse_request() refuses, and beyond kMaxRequestsPerPayload. Views
/// into the payload.
Expected<std::vector<Request>> split_requests(std::string_view payload);

/// Those that boards do not ignore.
struct PayloadLines {
    std::size_t count = 0;
    std::string_view first{};
};
PayloadLines lines_of(std::string_view payload);

}  // namespace asip::protocol
