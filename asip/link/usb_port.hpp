// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace asip::link {

/// The USB device behind a serial port; empty: there is none, or the kernel does not say.
struct UsbPort {
    std::string vendor;   ///< four hexadecimal digits: "1a86"
    std::string product;  ///< likewise
    std::string serial;   ///< number of the device
    std::string port;     ///< where it is plugged in: "3", behind a hub "1.3"
};

/// `sys`: another root, for tests.
UsbPort usb_port_of(const std::string& device, const std::string& sys = "/sys");

/// Clones have none, or all the same.
bool is_own_serial(std::string_view serial);

}  // namespace asip::link
