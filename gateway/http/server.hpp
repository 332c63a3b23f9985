// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/shares.hpp"
#include "asip/time.hpp"
#include "gateway/http/message.hpp"
#include "gateway/http/request_reader.hpp"

namespace boost::asio {
class io_context;
}

/// The server: connections, TLS, limits and time. What a request means is the handler's. All of it runs on
/// one io_context and one thread; every callback comes from there.
namespace asip::gateway::http {

/// What a streamed response sends. Asked for text whenever the client has taken what it was sent before, so
/// a slow client is asked for rarely and nothing piles up.
class Source {
  public:
    virtual ~Source() = default;
    /// Appends what there is to send, about `max` bytes at most. Nothing appended: `wake` is called when
    /// there is something.
    virtual void take(std::string& out, std::size_t max) = 0;
    /// Nothing more will come: the response ends.
    virtual bool finished() const = 0;
    /// take() appended nothing only because others have their turn first: it is asked again soon.
    virtual bool more() const { return false; }

    std::function<void()> wake = [] {};
};

/// One WebSocket connection. Asked for messages as a Source is for text.
class Channel {
  public:
    virtual ~Channel() = default;
    /// The next message to send. False: there is none; `wake` is called when there is.
    virtual bool take(std::string& message) = 0;
    /// As Source::more().
    virtual bool more() const { return false; }
    /// A whole text message. False: the client breaks the rules too often; the connection is closed.
    virtual bool received(std::string_view message) = 0;
    /// Non-zero: the connection is to be closed with this code (1008: not allowed any more).
    virtual std::uint16_t close_code() const { return 0; }

    std::function<void()> wake = [] {};
};

/// What waits for the answer to a request: a connection, or a test.
class Responder {
  public:
    virtual ~Responder() = default;
    virtual void respond(std::uint64_t number, Response response) = 0;
    virtual void stream(std::uint64_t number, Response head, std::unique_ptr<Source> source) = 0;
    virtual void upgrade(std::uint64_t number, std::unique_ptr<Channel> channel) = 0;
    virtual void in_turns(std::uint64_t number, bus::Shares::Job step) = 0;
    virtual bool waits_for(std::uint64_t number) const = 0;
};

/// Where the answer to one request goes. Copies are for the same request; the first answer counts, and after
/// the client is gone nothing happens. It keeps no connection open.
class Reply {
  public:
    using Finish = std::function<void(Response&)>;

    Reply(std::weak_ptr<Responder> responder, std::uint64_t number)
        : responder_(std::move(responder)), number_(number) {}

    /// The same, with something done to each answer before it is sent.
    Reply with(Finish finish) const {
        Reply result = *this;
        result.finish_ = std::make_shared<const Finish>(std::move(finish));
        return result;
    }
    void send(Response response) const {
        const auto responder = responder_.lock();
        if (!responder) return;
        if (finish_) (*finish_)(response);
        responder->respond(number_, std::move(response));
    }
    /// `head` has the status and headers.
    void stream(Response head, std::unique_ptr<Source> source) const {
        const auto responder = responder_.lock();
        if (!responder) return;
        if (finish_) (*finish_)(head);
        responder->stream(number_, std::move(head), std::move(source));
    }
    /// Only while the handler is being called. The request must be a valid upgrade: is_upgrade().
    void websocket(std::unique_ptr<Channel> channel) const {
        if (const auto responder = responder_.lock()) responder->upgrade(number_, std::move(channel));
    }
    /// Only while the handler is being called. An answer that costs much: `step` is called, each time in
    /// another turn of its asker and ahead of its other requests, until it returns false or no client waits
    /// any more. A step should take a millisecond or two.
    void in_turns(bus::Shares::Job step) const {
        if (const auto responder = responder_.lock()) responder->in_turns(number_, std::move(step));
    }
    /// No client waits for an answer any more: it was given, or the client closed the connection.
    bool gone() const {
        const auto responder = responder_.lock();
        return !responder || !responder->waits_for(number_);
    }

  private:
    std::weak_ptr<Responder> responder_;
    std::uint64_t number_;
    std::shared_ptr<const Finish> finish_;
};

/// Beyond these a connection is refused, answered with a status, or closed; none of them ends the server.
struct ServerLimits {
    RequestReader::Limits request;
    std::size_t connections = 12'000;             ///< of all addresses
    std::size_t connections_per_address = 1'000;  ///< of IPv6 a /64: network_of()
    std::size_t handshakes_per_address = 64;      ///< of TLS, under way
    /// Requests that are not whole yet, or wait behind another one: of an address, and of all together.
    std::size_t input_bytes_per_address = std::size_t{16} << 20;
    std::size_t input_bytes = std::size_t{128} << 20;
    /// Connections from this machine are a proxy's, and have many clients: limits of an address are not
    /// theirs.
    bool behind_proxy = false;
    std::size_t message_bytes = 64 * 1024;          ///< of a WebSocket
    std::size_t stream_bytes = 16 * 1024;           ///< handed to the socket at once
    Duration head_time = std::chrono::seconds(10);  ///< from the first byte (or the connection) to the last
    Duration body_time = std::chrono::seconds(30);
    Duration idle_time = std::chrono::seconds(75);   ///< between requests
    Duration write_time = std::chrono::seconds(60);  ///< for a whole response that is no stream
};

/// To whom the cost of a request is counted, and whether it goes ahead of all others.
struct Asker {
    std::string name;
    bool urgent = false;
};

/// Since the server was made, but for what is "now".
struct ServerCounters {
    std::uint64_t accepted = 0;
    std::uint64_t turned_away = 0;  ///< beyond a limit of connections
    std::uint64_t requests = 0;
    std::uint64_t broken = 0;     ///< requests that were not HTTP
    std::uint64_t timed_out = 0;  ///< connections closed for being too slow or idle
    std::size_t open = 0;         ///< now
    std::size_t streams = 0;      ///< now
    std::size_t websockets = 0;   ///< now
    std::uint64_t sent_bytes = 0;
};

/// Listens, reads requests, and hands each to the handler. Connections that are open when it ends are closed.
class Server {
  public:
    /// Called for each whole request, when it is its asker's turn. May answer at once or keep the reply for
    /// later.
    using Handler = std::function<void(const Request&, const Reply&)>;
    /// Called for each whole request as it comes: it must cost little.
    using AskerOf = std::function<Asker(const Request&)>;
    struct Tls {
        std::string cert_file;  ///< PEM, the whole chain
        std::string key_file;
    };
    struct Options {
        /// "127.0.0.1:8080", "[::1]:8080", "unix:/run/asip/gateway.sock"
        std::vector<std::string> addresses;
        std::unique_ptr<Tls> tls;  ///< null: none
        ServerLimits limits;
    };

    /// Binds. Throws std::runtime_error with a sentence where an address or certificate cannot be used.
    /// `shares`: by which requests, messages and streams have their turns; it must outlive the server.
    Server(boost::asio::io_context& io, Options options, bus::Shares& shares, AskerOf asker_of,
           Handler handler);
    ~Server();

    /// Accepts connections from now on. Call once.
    void start();
    /// Accepts no more and closes every connection; streams and WebSockets (1001) are told.
    void stop();
    /// The addresses as bound, with the port that was chosen for port 0.
    std::vector<std::string> addresses() const;
    ServerCounters counters() const;

    class Impl;

  private:
    std::shared_ptr<Impl> impl_;
};

}  // namespace asip::gateway::http
