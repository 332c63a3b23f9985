#pragma once
#include <boost/asio/io_context.hpp>
#include <functional>
#include <list>
#include <memory>
#include <string>

#include "agent/client_framing.hpp"
#include "asip/expected.hpp"
#include "asip/link/tcp_stream.hpp"

namespace asip::agent {

/// Offers the board to point-to-point clients over TCP: what the board says goes to each, what any of them
/// says goes to the board. A client that does not read is dropped once kMostUnsentBytes wait for it.
class PointToPoint {
  public:
    static constexpr std::size_t kMostUnsentBytes = 64 * 1024;
    static constexpr std::size_t kMostClients = 64;

    using LineHandler = std::function<void(std::string_view line)>;

    PointToPoint(boost::asio::io_context& io, LineHandler on_line) : io_(io), on_line_(std::move(on_line)) {}

    Expected<std::uint16_t, link::StreamError> listen(const link::TcpAddress& address);
    void broadcast(std::string_view line);
    void close();
    std::size_t clients() const { return clients_.size(); }

  private:
    struct Client {
        std::unique_ptr<link::ByteStream> stream;
        ClientFraming framing;
    };
    void accepted(std::unique_ptr<link::ByteStream> stream);
    void drop(std::list<Client>::iterator client, const char* why);

    boost::asio::io_context& io_;
    LineHandler on_line_;
    std::unique_ptr<link::TcpListener> listener_;
    std::list<Client> clients_;
};

}  // namespace asip::agent
