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

/// A host and a port, not looked up yet.
struct TcpAddress {
    std::string host;  ///< a name, or an address without brackets
    std::uint16_t port = 0;
};

/// Reads `HOST:PORT`, `[V6]:PORT`, and `PORT` or `:PORT` with `default_host` where that is not empty. Fails
/// with a reason for a person when there is no host, or no port from 0 to 65535.
Expected<TcpAddress> parse_tcp_address(std::string_view text, std::string_view default_host = {});

using TcpConnectHandler = std::function<void(Expected<std::unique_ptr<ByteStream>, StreamError>)>;

/// Connects with TCP_NODELAY and keep-alive, so that a peer that vanished without a word (power cut, cable
/// pulled) ends the stream within about ten seconds; calls `done` exactly once, from the io_context, after at
/// most `timeout`. Names are looked up without blocking. Fails with kNotThere (unknown host) or kUnreachable.
/// The attempt is abandoned, and `done` never called, when the returned handle is destroyed first.
std::shared_ptr<void> connect_tcp(boost::asio::io_context& io, const TcpAddress& address, Duration timeout,
                                  TcpConnectHandler done);

/// Accepts connections until destroyed.
class TcpListener {
  public:
    virtual ~TcpListener() = default;
    virtual std::uint16_t port() const = 0;  ///< the one bound, where 0 was asked for
};

/// Called on the io_context for each connection; nothing is read before start().
using TcpAcceptHandler = std::function<void(std::unique_ptr<ByteStream>)>;

/// Listens at once; `io` must outlive the listener. Fails when the address cannot be bound (kBusy: taken by
/// another program; kNoPermission).
Expected<std::unique_ptr<TcpListener>, StreamError> listen_tcp(boost::asio::io_context& io,
                                                               const TcpAddress& address,
                                                               TcpAcceptHandler accepted);

}  // namespace asip::link
