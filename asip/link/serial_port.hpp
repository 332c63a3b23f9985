// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>

#include "asip/expected.hpp"
#include "asip/link/byte_stream.hpp"

namespace boost::asio {
class io_context;
}

namespace asip::link {

/// A serial port (or a pseudo-terminal), raw, 8N1, ours alone (TIOCEXCL and an advisory lock). Closing it
/// does not reset the board; Linux raises DTR at the first opening, which resets boards with that line.
class SerialPort : public ByteStream {
  public:
    /// At once, so call it when nothing is unsent. 500000 and 1000000 work where the hardware has them. Fails
    /// where the driver cannot.
    virtual Expected<void> set_baud(int baud) = 0;
    virtual int baud() const = 0;

    /// True: the port has that line; pseudo-terminals do not.
    virtual bool set_dtr(bool on) = 0;

    /// Drops what is not yet read, and what is not yet sent.
    virtual void flush() = 0;
};

/// Fails with kNotThere, kBusy, kNoPermission, kNotASerialPort, or kFailed. Does not wait.
Expected<std::unique_ptr<SerialPort>, StreamError> open_serial(boost::asio::io_context& io,
                                                               const std::string& device, int baud = 57600);

/// The name of `device` across replugging: its link in `by-id` of `folder`, or in `by-path` where the device
/// has no serial number of its own, else `device`. `sys`: another root, for tests.
std::string stable_path(const std::string& device, const std::string& folder = "/dev/serial",
                        const std::string& sys = "/sys");

}  // namespace asip::link
