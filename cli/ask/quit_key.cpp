// SPDX-License-Identifier: Apache-2.0
#include "cli/ask/quit_key.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <boost/asio/buffer.hpp>
#include <utility>

namespace asip::cli {

QuitKey::QuitKey(boost::asio::io_context& io, std::function<void()> pressed)
    : input_(io), pressed_(std::move(pressed)) {
    if (::isatty(STDIN_FILENO) == 0 || ::tcgetpgrp(STDIN_FILENO) != ::getpgrp()) return;
    if (::tcgetattr(STDIN_FILENO, &before_) != 0) return;
    auto keys = before_;
    keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    keys.c_cc[VMIN] = 1;
    keys.c_cc[VTIME] = 0;
    changed_ = ::tcsetattr(STDIN_FILENO, TCSANOW, &keys) == 0;
    // Opened again, it is another one than standard output's, which Asio would make one that does not wait: a
    // terminal that takes nothing (Ctrl-S) would be a failure to write.
    const int own = ::open("/dev/tty", O_RDONLY | O_NOCTTY | O_CLOEXEC);
    if (!changed_ || own < 0) return;
    input_.assign(own);
    wait();
}

QuitKey::~QuitKey() {
    boost::system::error_code ignored;
    input_.close(ignored);
    if (changed_) ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

void QuitKey::wait() {
    input_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                      [this](const boost::system::error_code& error) {
                          if (error || ::read(input_.native_handle(), &key_, 1) != 1) return;
                          if (key_ == 'q' || key_ == 'Q') return pressed_();
                          wait();
                      });
}

}  // namespace asip::cli
