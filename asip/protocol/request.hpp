#pragma once
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "asip/protocol/pin.hpp"

namespace asip::protocol {

// Request lines, all without a newline.

inline constexpr std::string_view kAskInfo = "#,?";
inline constexpr std::string_view kAskServiceNames = "#,N";
inline constexpr std::string_view kAskPinOwners = "#,S";
inline constexpr std::string_view kAskExtensions = "#,X";
inline constexpr std::string_view kAskIdentity = "#,I";
inline constexpr std::string_view kRestart = "#,R";
inline constexpr std::string_view kAskPortMap = "I,M";
inline constexpr std::string_view kAskAnalogMap = "I,m";
inline constexpr std::string_view kAskPinModes = "I,p";
inline constexpr std::string_view kAskPinCapabilities = "I,c";

/// make_request('S', 'W', {0, 90}) -> "S,W,0,90".
std::string make_request(char service, char tag, std::initializer_list<int> parameters = {});
std::string set_pin_mode(int pin, PinMode mode);
std::string digital_write(int pin, bool high);
std::string analog_write(int pin, int value);
std::string analog_period(int milliseconds);
/// Token: 1 to 8 letters or digits.
std::string echo(std::string_view token);
std::string set_identity(std::string_view name);
std::string set_line_rate(int baud);
std::string set_checksum(bool on);

/// `S,t[,params]` taken apart; views into the line.
struct Request {
    char service;
    char tag;
    std::string_view parameters;  // without the comma before them; may be empty
};

/// Fails when the line is longer than kMaxRequestBytes, holds anything but printable ASCII, or is not a
/// request. A trailing line end is not allowed here; split_requests takes it off.
Expected<Request> parse_request(std::string_view line);

/// Control payload to request lines: newline or CR LF between them and at the end optional, empty lines
/// skipped. All or nothing: one bad line refuses the payload with the reason. Views point into the payload.
Expected<std::vector<std::string_view>> split_requests(std::string_view payload);

}  // namespace asip::protocol
