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

/// Connections, TLS, limits and time, on one io_context and thread. The handler knows what a request means.
namespace asip::gateway::http {

/// What a streamed response sends; asked whenever the client took all, so that nothing piles up for slow
/// ones.
class Source {
  public:
    virtual ~Source() = default;
    /// Appends about `max` bytes at most; nothing: `wake` is called later.
    virtual void take(std::string& out, std::size_t max) = 0;
    /// The response ends.
    virtual bool finished() const = 0;
    /// Others have their turn first: ask again soon.
    virtual bool more() const { return false; }

    std::function<void()> wake = [] {};
};

/// A WebSocket connection, asked for messages as a Source is for text.
class Channel {
  public:
    virtual ~Channel() = default;
    /// False: there is none; `wake` is called later.
    virtual bool take(std::string& message) = 0;
    virtual bool more() const { return false; }
    /// Messages are bytes, in both directions; else they are text.
    virtual bool binary() const { return false; }
    /// A whole message. False: the client breaks the rules too often, and is closed.
    virtual bool received(std::string_view message) = 0;
    /// Non-zero: close with this code (1008: not allowed any more).
    virtual std::uint16_t close_code() const { return 0; }

    std::function<void()> wake = [] {};
};

/// A connection, or a test.
class Responder {
  public:
    virtual ~Responder() = default;
    virtual void respond(std::uint64_t number, Response response) = 0;
    virtual void stream(std::uint64_t number, Response head, std::unique_ptr<Source> source) = 0;
    virtual void upgrade(std::uint64_t number, std::unique_ptr<Channel> channel) = 0;
    virtual void in_turns(std::uint64_t number, bus::Shares::Job step) = 0;
    virtual bool waits_for(std::uint64_t number) const = 0;
};

/// Where an answer goes. The first one counts; behind the client's end nothing happens. It keeps no
/// connection open.
class Reply {
  public:
    using Finish = std::function<void(Response&)>;

    Reply(std::weak_ptr<Responder> responder, std::uint64_t number)
        : responder_(std::move(responder)), number_(number) {}

    /// The same, with something done to each answer first.
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
    /// `head`: status and headers.
    void stream(Response head, std::unique_ptr<Source> source) const {
        const auto responder = responder_.lock();
        if (!responder) return;
        if (finish_) (*finish_)(head);
        responder->stream(number_, std::move(head), std::move(source));
    }
    /// Only while the handler is called, for a request with is_upgrade().
    void websocket(std::unique_ptr<Channel> channel) const {
        if (const auto responder = responder_.lock()) responder->upgrade(number_, std::move(channel));
    }
    /// For a costly answer, only while the handler is called: `step` is called in turns of its asker, ahead
    /// of its other requests, until it returns false or no client waits. A step takes a millisecond or two.
    void in_turns(bus::Shares::Job step) const {
        if (const auto responder = responder_.lock()) responder->in_turns(number_, std::move(step));
    }
    /// The answer was given, or the client closed the connection.
    bool gone() const {
        const auto responder = responder_.lock();
        return !responder || !responder->waits_for(number_);
    }

  private:
    std::weak_ptr<Responder> responder_;
    std::uint64_t number_;
    std::shared_ptr<const Finish> finish_;
};

/// Beyond these a connection is refused, answered with a status, or closed.
struct ServerLimits {
    RequestReader::Limits request;
    std::size_t connections = 12'000;             ///< of all addresses
    std::size_t connections_per_address = 1'000;  ///< of IPv6 a /64: network_of()
    std::size_t handshakes_per_address = 64;      ///< of TLS, under way
    /// Requests that are not whole yet, or wait behind another one: of an address, and of all together.
    std::size_t input_bytes_per_address = std::size_t{16} << 20;
    std::size_t input_bytes = std::size_t{128} << 20;
    /// Connections from this machine are a proxy's: limits of an address do not hold.
    bool behind_proxy = false;
    std::size_t message_bytes = 64 * 1024;          ///< of a WebSocket
    std::size_t stream_bytes = 16 * 1024;           ///< handed to the socket at once
    Duration head_time = std::chrono::seconds(10);  ///< from the first byte (or the connection) to the last
    Duration body_time = std::chrono::seconds(30);
    Duration idle_time = std::chrono::seconds(75);   ///< between requests
    Duration write_time = std::chrono::seconds(60);  ///< for a whole response that is no stream
};

/// To whom a request is counted, and whether it goes first.
struct Asker {
    std::string name;
    bool urgent = false;
};

/// Since the start, but for what is "now".
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

/// Hands each request to the handler. Its end closes all connections.
class Server {
  public:
    /// In its asker's turn. May keep the reply for later.
    using Handler = std::function<void(const Request&, const Reply&)>;
    /// For each whole request as it comes; it must cost little.
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

    /// Binds. Throws std::runtime_error on an address or certificate that cannot be used. `shares`: gives
    /// requests, messages and streams their turns.
    Server(boost::asio::io_context& io, Options options, bus::Shares& shares, AskerOf asker_of,
           Handler handler);
    ~Server();

    /// Call once.
    void start();
    /// Closes all; streams and WebSockets (1001) are told.
    void stop();
    /// With the port that was chosen for port 0.
    std::vector<std::string> addresses() const;
    ServerCounters counters() const;

    class Impl;

  private:
    std::shared_ptr<Impl> impl_;
};

}  // namespace asip::gateway::http
