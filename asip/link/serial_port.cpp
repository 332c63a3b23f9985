// SPDX-License-Identifier: Apache-2.0
#include "asip/link/serial_port.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <cerrno>
#include <cstring>

#include "asip/descriptor.hpp"
#include "asip/link/baud.hpp"
#include "asip/link/stream_base.hpp"

namespace asip::link {
namespace {

namespace asio = boost::asio;
using Kind = StreamError::Kind;
using Descriptor = asio::posix::stream_descriptor;

Unexpected<StreamError> error(Kind kind, std::string text) {
    return Unexpected<StreamError>(StreamError{kind, std::move(text)});
}

StreamError open_error(const std::string& device, int problem) {
    switch (problem) {
        case ENOENT:
        case ENXIO:
        case ENODEV:
            return {Kind::kNotThere, device + " is not there; is the board plugged in?"};
        case EBUSY:
            return {Kind::kBusy, device + " is in use by another program; close it there first"};
        case EACCES:
        case EPERM:
            return {
                Kind::kNoPermission,
                "no permission to open " + device +
                    "; add your user to the group dialout (sudo usermod -aG dialout $USER) and log in again"};
        case ENOTTY:
        case EISDIR:
            return {Kind::kNotASerialPort, device + " is not a serial port"};
        default:
            return {Kind::kFailed, "cannot open " + device + ": " + std::strerror(problem)};
    }
}

/// Raw, 8N1, no flow control, and closing leaves DTR as it is.
bool make_raw(int fd) {
    termios settings{};
    if (tcgetattr(fd, &settings) != 0) return false;
    cfmakeraw(&settings);
    settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS | HUPCL);
    settings.c_cflag |= CLOCAL | CREAD | CS8;
    settings.c_iflag &= ~static_cast<tcflag_t>(IXON | IXOFF | IXANY);
    settings.c_cc[VMIN] = 1;
    settings.c_cc[VTIME] = 0;
    return tcsetattr(fd, TCSANOW, &settings) == 0;
}

class Port final : public CoreStream<Descriptor, SerialPort> {
  public:
    using CoreStream::CoreStream;
    ~Port() override { Port::close(); }

    void close() override {
        // The mark belongs to the terminal, not to us: where another program keeps a pseudo-terminal open
        // it would stay.
        if (socket().is_open()) ioctl(fd(), TIOCNXCL);
        CoreStream::close();
    }
    Expected<void> set_baud(int wanted) override {
        // Waiting would block the loop; what the caller wrote has left the queue when unsent_bytes() is 0.
        // What came at the rate before is nothing that was sent at this one.
        tcflush(fd(), TCIFLUSH);
        if (!set_terminal_baud(fd(), wanted)) {
            return fail(describe() + " cannot run at " + std::to_string(wanted) +
                        " baud: " + std::strerror(errno));
        }
        return {};
    }
    int baud() const override { return terminal_baud(fd()); }
    bool set_dtr(bool on) override {
        int line = TIOCM_DTR;
        return ioctl(fd(), on ? TIOCMBIS : TIOCMBIC, &line) == 0;
    }
    void flush() override { tcflush(fd(), TCIOFLUSH); }

  private:
    int fd() const { return const_cast<Port*>(this)->socket().native_handle(); }
};

}  // namespace

Expected<std::unique_ptr<SerialPort>, StreamError> open_serial(asio::io_context& io,
                                                               const std::string& device, int baud) {
    asip::Descriptor fd(::open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    if (fd.number() < 0) return Unexpected<StreamError>(open_error(device, errno));
    if (!isatty(fd.number())) return error(Kind::kNotASerialPort, device + " is not a serial port");
    // TIOCEXCL keeps later openers out, except those of root; the lock shows which programs opened
    // before.
    if (flock(fd.number(), LOCK_EX | LOCK_NB) != 0) return Unexpected<StreamError>(open_error(device, EBUSY));
    ioctl(fd.number(), TIOCEXCL);
    if (!make_raw(fd.number()))
        return error(Kind::kFailed, "cannot set up " + device + ": " + std::strerror(errno));
    if (!set_terminal_baud(fd.number(), baud))
        return error(Kind::kFailed, device + " cannot run at " + std::to_string(baud) + " baud");
    Descriptor descriptor(io);
    boost::system::error_code problem;
    descriptor.assign(fd.number(), problem);
    if (problem) return error(Kind::kFailed, "cannot use " + device + ": " + problem.message());
    fd.release();
    descriptor.non_blocking(true, problem);
    return std::make_unique<Port>(std::move(descriptor), device);
}

}  // namespace asip::link
