// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "asip/expected.hpp"

namespace asip::sim {

/// Command lines over a Unix socket. Answers are lines with a leading space, then "ok" or "error REASON".
class ControlSocket {
  public:
    using Reply = std::function<void(Expected<std::string>)>;
    /// May reply from another thread.
    using Execute = std::function<void(std::string_view line, Reply reply)>;

    /// Replaces a socket without a program; refuses one in use, and other files.
    static Expected<std::unique_ptr<ControlSocket>> open(boost::asio::io_context& context,
                                                         const std::filesystem::path& path, Execute execute);
    ~ControlSocket();

  private:
    class Connection;
    ControlSocket(boost::asio::io_context& context, std::filesystem::path path, Execute execute);
    void accept();

    boost::asio::io_context& context_;
    boost::asio::local::stream_protocol::acceptor acceptor_;
    std::filesystem::path path_;
    Execute execute_;
};

/// Without --socket: one for each user.
std::filesystem::path usual_control_socket();

/// Sends a command, prints its lines. The error is the command's or the socket's.
struct ControlError {
    bool reached = false;  ///< false: no program listens there
    std::string text;
};
Expected<std::string, ControlError> send_control(const std::filesystem::path& path, std::string_view line);

}  // namespace asip::sim
