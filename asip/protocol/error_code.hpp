// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace asip::protocol {

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

}  // namespace asip::protocol
