// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace asip::link {

/// What the kernel knows of the USB device behind a serial port. Empty: it is none, or the kernel does not
/// say.
struct UsbPort {
    std::string vendor;   ///< four hexadecimal digits: "1a86"
    std::string product;  ///< likewise
    std::string serial;   ///< number of the device
    std::string port;     ///< where it is plugged in: "3", behind a hub "1.3"
};

/// `sys`: another root, for tests.
UsbPort usb_port_of(const std::string& device, const std::string& sys = "/sys");

/// Whether a serial number tells two devices of one kind apart: clones have none, or all of them the same.
bool is_own_serial(std::string_view serial);

}  // namespace asip::link
