// SPDX-License-Identifier: Apache-2.0
// The errors of the protocol, by the numbers that go over the wire.
#pragma once

#include <stdint.h>

#include "Config.h"
#include "Flash.h"

namespace asip {

enum class Error : uint8_t {
    kNone = 0,
    kInvalidService = 1,
    kUnknownRequest = 2,
    kInvalidPin = 3,
    kModeUnavailable = 4,
    kInvalidMode = 5,
    kWrongMode = 6,
    kInvalidDeviceNumber = 7,
    kDeviceNotAvailable = 8,
    kI2cNotEnabled = 9,
    kBadChecksum = 10,
    // A number missing or malformed, a value not allowed, a line too long. A 0.4 board has no such error
    // and calls it an unknown request, which its peers understand.
    kBadArgument = kExtensions ? 11 : 2,
};

// Name as sent between the braces, e.g. INVALID_PIN.
FlashText errorText(Error error);

}  // namespace asip
