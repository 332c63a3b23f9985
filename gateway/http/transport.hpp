// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <concepts>
#include <memory>
#include <utility>

namespace asip::gateway::http {

/// TCP or Unix, with or without TLS: one type, so that what uses it is compiled once.
class Transport {
  public:
    using Socket = boost::asio::generic::stream_protocol::socket;
    using Tls = boost::asio::ssl::stream<Socket&>;
    using executor_type = Socket::executor_type;

    explicit Transport(Socket socket) : socket_(std::make_unique<Socket>(std::move(socket))) {}

    /// Before anything is read or written; the handshake is the caller's.
    void use_tls(boost::asio::ssl::context& context) { tls_ = std::make_unique<Tls>(*socket_, context); }
    Tls* tls() { return tls_.get(); }
    Socket& socket() { return *socket_; }
    executor_type get_executor() { return socket_->get_executor(); }

    template <class Buffers, class Handler>
    void async_read_some(const Buffers& buffers, Handler&& handler) {
        read_some(first_of<boost::asio::mutable_buffer, 1>(buffers)[0],
                  Ended(std::forward<Handler>(handler)));
    }
    template <class Buffers, class Handler>
    void async_write_some(const Buffers& buffers, Handler&& handler) {
        write_some(first_of<boost::asio::const_buffer, kBuffers>(buffers),
                   Ended(std::forward<Handler>(handler)));
    }

    /// At once, without the good-byes of TLS.
    void close();

  private:
    using ErrorCode = boost::system::error_code;
    static constexpr std::size_t kBuffers = 4;  // of one write; what is behind them is for the next

    /// Called at the end of a transfer. One type for all handlers: Asio's part is compiled once, in
    /// transport.cpp.
    class Ended {
      public:
        template <class Handler>
            requires(!std::same_as<std::decay_t<Handler>, Ended>)
        explicit Ended(Handler&& handler)
            : held_(std::make_unique<Held<std::decay_t<Handler>>>(std::forward<Handler>(handler))) {}
        void operator()(const ErrorCode& error, std::size_t bytes) { held_->call(error, bytes); }

      private:
        struct Callable {
            virtual ~Callable() = default;
            virtual void call(const ErrorCode& error, std::size_t bytes) = 0;
        };
        template <class Handler>
        struct Held final : Callable {
            template <class From>
            explicit Held(From&& from) : handler(std::forward<From>(from)) {}
            void call(const ErrorCode& error, std::size_t bytes) override { handler(error, bytes); }
            Handler handler;
        };
        std::unique_ptr<Callable> held_;
    };

    /// Those that are not empty.
    template <class Buffer, std::size_t count, class Buffers>
    static std::array<Buffer, count> first_of(const Buffers& buffers) {
        std::array<Buffer, count> result;
        std::size_t used = 0;
        const auto end = boost::asio::buffer_sequence_end(buffers);
        for (auto next = boost::asio::buffer_sequence_begin(buffers); next != end && used < count; ++next) {
            const Buffer buffer = *next;
            if (buffer.size() > 0) result[used++] = buffer;
        }
        return result;
    }

    void read_some(boost::asio::mutable_buffer buffer, Ended ended);
    void write_some(const std::array<boost::asio::const_buffer, kBuffers>& buffers, Ended ended);

    std::unique_ptr<Socket> socket_;  // stays where it is when this object moves
    std::unique_ptr<Tls> tls_;
};

}  // namespace asip::gateway::http
