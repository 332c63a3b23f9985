// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/streambuf.hpp>
#include <functional>
#include <string>

namespace asip::sim {

/// Commands on standard input, one a line. The end of the input ends nothing: a service has none.
class InputCommands {
  public:
    using Execute = std::function<void(std::string line)>;

    /// Where standard input is a file, all its lines are executed at once. In the background of a shell no
    /// commands are read from the terminal.
    InputCommands(boost::asio::io_context& context, Execute execute);

  private:
    void read();
    void execute(const std::string& line);

    boost::asio::posix::stream_descriptor descriptor_;
    boost::asio::streambuf input_;
    Execute execute_;
    bool first_ = true;  // some editors put a mark before it
};

}  // namespace asip::sim
