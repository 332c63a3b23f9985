// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fcntl.h>
#include <gtest/gtest.h>
#include <termios.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace asip::link {

/// The board's end of a pseudo-terminal.
class Pty {
  public:
    Pty() : master_(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
        grantpt(master_);
        unlockpt(master_);
        char name[64] = {};
        ptsname_r(master_, name, sizeof name);
        device_ = name;
    }
    ~Pty() { unplug(); }
    const std::string& device() const { return device_; }
    void send(const std::string& bytes) {
        ASSERT_EQ(::write(master_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
    }
    std::string read_some() {
        char buffer[4096];
        const auto size = ::read(master_, buffer, sizeof buffer);
        return size > 0 ? std::string(buffer, static_cast<std::size_t>(size)) : "";
    }
    speed_t speed() const {
        termios settings{};
        tcgetattr(master_, &settings);
        return cfgetospeed(&settings);
    }
    tcflag_t control_flags() const {
        termios settings{};
        tcgetattr(master_, &settings);
        return settings.c_cflag;
    }
    void unplug() {
        if (master_ >= 0) close(master_);
        master_ = -1;
    }

  private:
    int master_;
    std::string device_;
};

}  // namespace asip::link
