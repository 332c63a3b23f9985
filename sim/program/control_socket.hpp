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

/// Receives command lines over a Unix socket. Each is answered by lines that begin with a space and then "ok"
/// or "error REASON".
class ControlSocket {
  public:
    using Reply = std::function<void(Expected<std::string>)>;
    /// Does a command; may reply from another thread.
    using Execute = std::function<void(std::string_view line, Reply reply)>;

    /// Replaces a socket on which no program answers; refuses one that is in use, or a file that is not a
    /// socket.
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

/// Where asip-sim listens without --socket: one path for each user.
std::filesystem::path usual_control_socket();

/// The other side: sends one command, prints its lines to standard output. The error is the command's or the
/// socket's.
struct ControlError {
    bool reached = false;  ///< false: no program listens there
    std::string text;
};
Expected<std::string, ControlError> send_control(const std::filesystem::path& path, std::string_view line);

}  // namespace asip::sim
