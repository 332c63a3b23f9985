#pragma once
#include <string_view>

namespace asip::protocol {

/// What a board answers behind `~S,t,`. A board may send numbers that are not listed; keep those as int.
enum class ErrorCode : int {
    NoError = 0,
    InvalidService = 1,
    UnknownRequest = 2,
    InvalidPin = 3,
    ModeUnavailable = 4,
    InvalidMode = 5,
    WrongMode = 6,
    InvalidDeviceNumber = 7,
    DeviceNotAvailable = 8,
    I2cNotEnabled = 9,
    BadChecksum = 10,  // extension C
    BadArgument = 11,  // boards with extensions
};

/// The name on the wire, such as "INVALID_DEVICE_NUMBER"; "UNKNOWN_ERROR" for numbers that have none.
std::string_view error_name(int code);
inline std::string_view error_name(ErrorCode code) {
    return error_name(static_cast<int>(code));
}

}  // namespace asip::protocol
