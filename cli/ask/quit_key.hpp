// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <termios.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <functional>

namespace asip::cli {

/// Calls `pressed` when `q` is pressed on the terminal that standard input is, without waiting for Enter.
/// Nothing where it is no terminal, or is in other hands (a job in the background). The terminal is as it was
/// when this ends.
class QuitKey {
  public:
    QuitKey(boost::asio::io_context& io, std::function<void()> pressed);
    ~QuitKey();
    QuitKey(const QuitKey&) = delete;
    QuitKey& operator=(const QuitKey&) = delete;

  private:
    void wait();

    boost::asio::posix::stream_descriptor input_;
    std::function<void()> pressed_;
    bool changed_ = false;
    termios before_{};
    char key_ = 0;
};

}  // namespace asip::cli
