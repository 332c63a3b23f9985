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

/// A serial port (or a pseudo-terminal), raw, 8N1, ours alone (TIOCEXCL and an advisory lock), with "hang up
/// on close" cleared so that closing it does not reset the board. Linux raises DTR when it opens a port; on
/// boards that reset themselves by DTR that first edge cannot be avoided, later ones are the caller's choice.
class SerialPort : public ByteStream {
  public:
    /// Sets the speed at once, also mid-stream; call it when nothing is unsent. 500000 and 1000000 work where
    /// the hardware has them. Fails when the driver cannot.
    virtual Expected<void> set_baud(int baud) = 0;
    /// The rate now.
    virtual int baud() const = 0;

    /// Raises or drops DTR. True when the port has that line; pseudo-terminals do not.
    virtual bool set_dtr(bool on) = 0;

    /// Throws away what was received and not yet read, and what was written and not yet sent.
    virtual void flush() = 0;
};

/// Opens `device`. Fails with kNotThere, kBusy, kNoPermission, kNotASerialPort, or kFailed (the driver cannot
/// run at `baud`, for example). Does not wait. `io` must outlive the port.
Expected<std::unique_ptr<SerialPort>, StreamError> open_serial(boost::asio::io_context& io,
                                                               const std::string& device, int baud = 57600);

/// The name of `device` that survives replugging: its link in `by-id` of `folder`, or in `by-path` where its
/// device has no serial number of its own; where it has none, `device` as given. Open by this name again
/// after the port vanished: the kernel may have numbered it differently. `sys`: another root, for tests.
std::string stable_path(const std::string& device, const std::string& folder = "/dev/serial",
                        const std::string& sys = "/sys");

}  // namespace asip::link
