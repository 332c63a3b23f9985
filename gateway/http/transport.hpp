// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <memory>
#include <utility>

namespace asip::gateway::http {

/// The byte stream of a connection, TCP or Unix, with or without TLS: one type, so that what is built on it
/// is compiled once.
class Transport {
  public:
    using Socket = boost::asio::generic::stream_protocol::socket;
    using Tls = boost::asio::ssl::stream<Socket&>;
    using executor_type = Socket::executor_type;

    explicit Transport(Socket socket) : socket_(std::make_unique<Socket>(std::move(socket))) {}

    /// From now on; the handshake is the caller's. Before anything is read or written.
    void use_tls(boost::asio::ssl::context& context) { tls_ = std::make_unique<Tls>(*socket_, context); }
    Tls* tls() { return tls_.get(); }
    Socket& socket() { return *socket_; }
    executor_type get_executor() { return socket_->get_executor(); }

    template <class Buffers, class Handler>
    void async_read_some(const Buffers& buffers, Handler&& handler) {
        if (tls_) return tls_->async_read_some(buffers, std::forward<Handler>(handler));
        socket_->async_read_some(buffers, std::forward<Handler>(handler));
    }
    template <class Buffers, class Handler>
    void async_write_some(const Buffers& buffers, Handler&& handler) {
        if (tls_) return tls_->async_write_some(buffers, std::forward<Handler>(handler));
        socket_->async_write_some(buffers, std::forward<Handler>(handler));
    }

    /// At once, without the good-byes of TLS: what is under way ends with an error.
    void close() {
        boost::system::error_code ignored;
        socket_->shutdown(Socket::shutdown_both, ignored);
        socket_->close(ignored);
    }

  private:
    std::unique_ptr<Socket> socket_;  // stays where it is when this object moves
    std::unique_ptr<Tls> tls_;
};

}  // namespace asip::gateway::http
