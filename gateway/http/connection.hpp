// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>

#include "gateway/http/server.hpp"
#include "gateway/http/transport.hpp"
#include "gateway/http/websocket.hpp"

namespace asip::gateway::http {

/// Shared by the connections of an address.
struct AddressUse {
    std::size_t connections = 0;
    std::size_t input_bytes = 0;
    std::size_t handshakes = 0;  // of TLS, under way
};

/// Shared by the connections of a server.
struct Shared {
    explicit Shared(bus::Shares& all) : shares(all) {}

    bus::Shares& shares;
    Server::AskerOf asker_of;
    Server::Handler handler;
    ServerLimits limits;
    ServerCounters counters;
    std::size_t input_bytes = 0;
    std::unordered_map<std::string, AddressUse> addresses;  // those with connections
};

/// One connection: reads a request, has it handled, writes the response, and so on; or becomes a stream or a
/// WebSocket. What a client sends ahead waits, within bounds. Held by what is under way, and by the server.
class Connection final : public Responder, public std::enable_shared_from_this<Connection> {
  public:
    /// `address`: its limits count; empty: none do.
    Connection(std::shared_ptr<Shared> shared, Transport transport, Peer peer, std::string address);
    ~Connection() override;

    /// `tls`: null: none. Call once.
    void start(boost::asio::ssl::context* tls);
    /// At once, whatever is under way.
    void close();
    /// The server ends: tells streams and WebSockets, and closes.
    void leave();
    /// Closes what is too slow. Call a few times a second.
    void sweep(Time now);
    bool closed() const { return phase_ == Phase::kClosed; }

    void respond(std::uint64_t number, Response response) override;
    void stream(std::uint64_t number, Response head, std::unique_ptr<Source> source) override;
    void upgrade(std::uint64_t number, std::unique_ptr<Channel> channel) override;
    void in_turns(std::uint64_t number, bus::Shares::Job step) override;
    bool waits_for(std::uint64_t number) const override {
        return phase_ == Phase::kHandling && number == number_;
    }

  private:
    enum class Phase { kHandshake, kReading, kHandling, kWriting, kStreaming, kWebSocket, kClosed };

    void shakes_hands(bool now);
    void handshake(boost::asio::ssl::context& tls);
    /// What was asked without TLS is at `https:`.
    void lead_to_tls();
    void read();
    void received(const boost::system::error_code& error, std::size_t bytes);
    void feed();
    void handle();
    /// True: there is another step.
    bool serve();
    void refuse(int status, std::string_view text);
    void write(std::string head, Response response, bool keep_alive);
    void written(const boost::system::error_code& error, std::size_t bytes);
    void next_request();
    /// False: that is too much for its address, or for all.
    bool count_input(std::size_t bytes);
    void pump();
    void pump_later();
    void chunk_written(const boost::system::error_code& error, std::size_t bytes);
    void until(Duration time) { deadline_ = Clock::now() + time; }

    std::shared_ptr<Shared> shared_;
    Transport transport_;
    Peer peer_;
    std::string address_;
    AddressUse* use_ = nullptr;  // of the address
    std::size_t counted_ = 0;    // bytes of input
    Phase phase_ = Phase::kHandshake;
    std::optional<Time> deadline_;
    std::uint64_t number_ = 0;  // of the request
    bool read_pending_ = false;
    bool write_pending_ = false;
    bool taking_ = false;  // the source is asked
    bool keep_alive_ = true;
    bool head_only_ = false;
    bool old_client_ = false;  // HTTP/1.0: no chunks
    bool last_chunk_ = false;
    bool pump_due_ = false;
    std::string in_;
    std::optional<RequestReader> reader_;
    std::size_t read_bytes_ = 0;  // by the reader
    std::optional<Request> request_;
    Asker asker_;
    bool in_handshake_ = false;
    bus::Shares::Job step_;  // of an answer that costs much
    std::string head_;
    Response response_;
    std::unique_ptr<Source> source_;
    std::shared_ptr<WebSocket> websocket_;
    std::array<char, 4096> buffer_;
};

}  // namespace asip::gateway::http
