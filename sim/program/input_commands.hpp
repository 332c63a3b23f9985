// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <functional>
#include <string>

#include "asip/protocol/line_reader.hpp"
#include "asip/protocol/request.hpp"

namespace asip::sim {

/// Commands on standard input. Its end ends nothing: a service has none.
class InputCommands {
  public:
    using Execute = std::function<void(std::string line)>;

    /// A file is executed at once. A program in the background of a shell reads no terminal.
    InputCommands(boost::asio::io_context& context, Execute execute);

  private:
    void read();
    void take(std::size_t size);
    void take_end();

    boost::asio::posix::stream_descriptor descriptor_;
    std::array<char, 1024> input_;
    protocol::LineReader lines_{protocol::kMaxBoardLineBytes, protocol::kRequestEnds};
    Execute execute_;
    bool first_ = true;  // some editors put a mark before it
};

}  // namespace asip::sim
