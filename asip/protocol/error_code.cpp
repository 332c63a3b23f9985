// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/error_code.hpp"

#include <array>

namespace asip::protocol {

std::string_view error_name(int code) {
    static constexpr std::array<std::string_view, 12> kNames = {
        "NO_ERROR",        "INVALID_SERVICE",       "UNKNOWN_REQUEST",
        "INVALID_PIN",     "MODE_UNAVAILABLE",      "INVALID_MODE",
        "WRONG_MODE",      "INVALID_DEVICE_NUMBER", "DEVICE_NOT_AVAILABLE",
        "I2C_NOT_ENABLED", "BAD_CHECKSUM",          "BAD_ARGUMENT",
    };
    if (code < 0 || static_cast<std::size_t>(code) >= kNames.size()) return "UNKNOWN_ERROR";
    return kNames[static_cast<std::size_t>(code)];
}

}  // namespace asip::protocol
