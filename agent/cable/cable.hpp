// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/local/stream_protocol.hpp>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "asip/expected.hpp"
#include "asip/link/byte_stream.hpp"
#include "asip/link/cable_frames.hpp"

namespace boost::asio {
class io_context;
}

namespace asip::agent {

/// One board at a browser's computer, as a pseudo-terminal of this machine: what a program writes into that
/// goes to the board, at the rate that the program set. Each opening but the first restarts the board, as DTR
/// does at a serial port: a pseudo-terminal has no such line. One thread.
class Cable {
  public:
    struct Hello {
        std::string by;  ///< whose browser it is
        std::string vendor, product;
        std::string cable;  ///< the page's name for it; may be empty
        std::string place;  ///< of a pupil; empty: any of its lender
    };
    struct Handlers {
        std::function<void(const Hello&)> on_hello;
        /// Once. Destroy it later, not from here.
        std::function<void(const std::string& why)> on_gone;
    };
    using Socket = boost::asio::local::stream_protocol::socket;

    Cable(boost::asio::io_context& io, Socket socket, Handlers handlers);
    ~Cable();
    Cable(const Cable&) = delete;
    Cable& operator=(const Cable&) = delete;

    /// Call it once, when on_hello came. The port's name: "/dev/pts/7".
    Expected<std::string> open_port();
    void tell(link::CableKind kind, std::string_view payload);
    /// Another one has its place: its port is gone, and the gateway ends it.
    void replaced();

  private:
    /// What is not taken by the other side, before this one reads no more.
    static constexpr std::size_t kMaxUnsent = std::size_t{32} * 1024;

    void received(std::string_view bytes);
    void take(const link::CableMessage& message);
    void from_program(std::string_view bytes);
    void note_openings();
    void slow_down();
    void gone(const std::string& why);

    boost::asio::io_context& io_;
    Handlers handlers_;
    std::unique_ptr<link::ByteStream> gateway_;
    std::unique_ptr<link::ByteStream> port_;
    link::CableReader reader_;
    int master_ = -1;       // of port_, which closes it
    int slave_ = -1;        // held, so that the master is no closed terminal between two programs
    int openings_ = -1;     // inotify
    int programs_ = 0;      // that have the port open
    bool first_ = true;     // the port was not opened yet
    bool restart_ = false;  // before the next byte
    int baud_ = 0;          // as the page knows it
    bool gone_ = false;
};

}  // namespace asip::agent
