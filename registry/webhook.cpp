// SPDX-License-Identifier: Apache-2.0
#include "registry/webhook.hpp"

#include <array>
#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <optional>

namespace asip::registry {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using Error = boost::system::error_code;

std::string authorization(const std::string& user) {
    return user.empty() ? std::string() : "Authorization: Basic " + basic(user) + "\r\n";
}

}  // namespace

/// One message: each step begins the next, and the first that fails, or the time, ends it.
class Webhook::Exchange : public std::enable_shared_from_this<Exchange> {
  public:
    Exchange(asio::io_context& io, const WebhookAddress& address, const std::string& body, Done done)
        : address_(address),
          request_(
              "POST " + address.target + " HTTP/1.1\r\nHost: " + address.server.host_header() +
              "\r\nUser-Agent: asip-registry\r\nConnection: close\r\nContent-Type: application/json\r\n" +
              authorization(address.user) + "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" +
              body),
          done_(std::move(done)),
          resolver_(io),
          timer_(io),
          socket_(io) {}

    void start() {
        timer_.expires_after(kLimit);
        timer_.async_wait([self = shared_from_this()](const Error& error) {
            if (!error) self->end_by_answer("no answer within 10 s");
        });
        if (address_.server.tls) {
            Error error;
            context_.set_default_verify_paths(error);
            tls_.emplace(socket_, context_);
            tls_->set_verify_mode(asio::ssl::verify_peer);
            tls_->set_verify_callback(asio::ssl::host_name_verification(address_.server.host));
            SSL_set_tlsext_host_name(tls_->native_handle(), address_.server.host.c_str());
        }
        resolver_.async_resolve(
            address_.server.host, address_.server.port,
            [self = shared_from_this()](const Error& error, const tcp::resolver::results_type& found) {
                if (self->failed(error, "cannot find it")) return;
                asio::async_connect(self->socket_, found, [self](const Error& failure, const tcp::endpoint&) {
                    self->connected(failure);
                });
            });
    }

    /// `done` is not called any more.
    void abandon() {
        done_ = nullptr;
        end(Result::kFailed, {});
    }

  private:
    void connected(const Error& error) {
        if (failed(error, "cannot reach it")) return;
        if (!tls_) return send();
        tls_->async_handshake(asio::ssl::stream_base::client,
                              [self = shared_from_this()](const Error& failure) {
                                  if (!self->failed(failure, "no TLS")) self->send();
                              });
    }

    void send() {
        const auto sent = [self = shared_from_this()](const Error& error, std::size_t) {
            if (!self->failed(error, "cannot write")) self->receive();
        };
        tls_ ? asio::async_write(*tls_, asio::buffer(request_), sent)
             : asio::async_write(socket_, asio::buffer(request_), sent);
    }

    void receive() {
        const auto received = [self = shared_from_this()](const Error& error, std::size_t size) {
            if (self->ended_) return;
            self->answer_.add({self->piece_.data(), size});
            // One that closes behind its first line has answered.
            if (error || self->answer_.complete())
                return self->end_by_answer("gave no answer: " + error.message());
            self->receive();
        };
        tls_ ? tls_->async_read_some(asio::buffer(piece_), received)
             : socket_.async_read_some(asio::buffer(piece_), received);
    }

    void end_by_answer(const std::string& otherwise) {
        const auto verdict = answer_.verdict(address_, std::chrono::system_clock::now());
        if (!verdict) return end(Result::kFailed, otherwise);
        wait_ = verdict->wait;
        end(verdict->result, verdict->why);
    }

    bool failed(const Error& error, const char* what) {
        if (error) end(Result::kFailed, std::string(what) + ": " + error.message());
        return error || ended_;
    }

    void end(Result result, const std::string& why) {
        if (std::exchange(ended_, true)) return;
        timer_.cancel();
        resolver_.cancel();
        Error ignored;
        socket_.close(ignored);
        if (const auto done = std::exchange(done_, nullptr)) done(result, why, wait_);
    }

    const WebhookAddress address_;
    const std::string request_;
    Done done_;
    bool ended_ = false;
    tcp::resolver resolver_;
    asio::steady_timer timer_;
    asio::ssl::context context_{asio::ssl::context::tls_client};
    tcp::socket socket_;
    std::optional<asio::ssl::stream<tcp::socket&>> tls_;
    WebhookAnswer answer_;
    std::array<char, 4096> piece_{};
    Duration wait_{};
};

Expected<std::unique_ptr<Webhook>> Webhook::create(asio::io_context& io, const std::string& url) {
    auto parsed = parse_webhook(url);
    if (!parsed) return fail(parsed.error());
    return std::unique_ptr<Webhook>(new Webhook(io, std::move(*parsed)));
}

Webhook::~Webhook() {
    if (exchange_) exchange_->abandon();
}

void Webhook::post(std::string body, Done done) {
    if (exchange_) exchange_->abandon();
    exchange_ = std::make_shared<Exchange>(io_, address_, body, std::move(done));
    exchange_->start();
}

}  // namespace asip::registry
