// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "asip/expected.hpp"
#include "asip/link/byte_stream.hpp"
#include "asip/time.hpp"

namespace boost::asio {
class io_context;
}

namespace asip::link {

/// Not looked up yet.
struct TcpAddress {
    std::string host;  ///< a name, or an address without brackets
    std::uint16_t port = 0;
};

/// `HOST:PORT`, `[V6]:PORT`, and `PORT` or `:PORT` with a `default_host`. Fails with a reason for a person.
Expected<TcpAddress> parse_tcp_address(std::string_view text, std::string_view default_host = {});

using TcpConnectHandler = std::function<void(Expected<std::unique_ptr<ByteStream>, StreamError>)>;

/// Connects with TCP_NODELAY and keep-alive: a peer that vanished ends the stream within about ten seconds.
/// Calls `done` once, from the io_context, after at most `timeout`, unless the returned handle is destroyed
/// first. Looks names up without blocking. Fails with kNotThere (unknown host) or kUnreachable.
std::shared_ptr<void> connect_tcp(boost::asio::io_context& io, const TcpAddress& address, Duration timeout,
                                  TcpConnectHandler done);

/// Until destroyed.
class TcpListener {
  public:
    virtual ~TcpListener() = default;
    virtual std::uint16_t port() const = 0;  ///< the one bound, where 0 was asked for
};

/// Nothing is read before start().
using TcpAcceptHandler = std::function<void(std::unique_ptr<ByteStream>)>;

/// At once. Fails where the address cannot be bound (kBusy, kNoPermission).
Expected<std::unique_ptr<TcpListener>, StreamError> listen_tcp(boost::asio::io_context& io,
                                                               const TcpAddress& address,
                                                               TcpAcceptHandler accepted);

}  // namespace asip::link
