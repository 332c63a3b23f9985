// SPDX-License-Identifier: Apache-2.0
#include "registry/webhook.hpp"

#include <algorithm>
#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <cctype>
#include <cstdlib>
#include <optional>
#include <string_view>

namespace asip::registry {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using Error = boost::system::error_code;

constexpr std::size_t kMaxAnswerBytes = 16 * 1024;  // up to the end of its heads
constexpr std::size_t kMaxWords = 200;              // of its body, in the log
constexpr std::string_view kEndOfHeads = "\r\n\r\n";

std::string authorization(const std::string& user) {
    if (user.empty()) return {};
    std::string text(4 * ((user.size() + 2) / 3) + 1, '\0');
    text.resize(static_cast<std::size_t>(EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                                         reinterpret_cast<const unsigned char*>(user.data()),
                                                         static_cast<int>(user.size()))));
    return "Authorization: Basic " + text + "\r\n";
}

}  // namespace

/// One message: each step begins the next, and the first that fails, or the time, ends it.
class Webhook::Exchange : public std::enable_shared_from_this<Exchange> {
  public:
    Exchange(asio::io_context& io, const WebhookAddress& address, const std::string& body, Done done)
        : address_(address.server),
          address_target_(address.target),
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
            if (!error && self->verdict_) return self->end_by_verdict();
            if (!error) self->end(Result::kFailed, "no answer within 10 s");
        });
        if (address_.tls) {
            Error error;
            context_.set_default_verify_paths(error);
            tls_.emplace(socket_, context_);
            tls_->set_verify_mode(asio::ssl::verify_peer);
            tls_->set_verify_callback(asio::ssl::host_name_verification(address_.host));
            SSL_set_tlsext_host_name(tls_->native_handle(), address_.host.c_str());
        }
        resolver_.async_resolve(
            address_.host, address_.port,
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
        const auto received = [self = shared_from_this()](const Error& error, std::size_t) {
            // One that closes behind its first line has answered.
            if (self->answer_.find('\r') != std::string::npos || !self->failed(error, "gave no answer"))
                self->judge();
        };
        auto buffer = asio::dynamic_buffer(answer_, kMaxAnswerBytes);
        tls_ ? asio::async_read_until(*tls_, buffer, kEndOfHeads, received)
             : asio::async_read_until(socket_, buffer, kEndOfHeads, received);
    }

    void judge() {
        if (ended_) return;
        const auto line = answer_.substr(0, answer_.find('\r'));
        if (!line.starts_with("HTTP/1.") || line.size() < 12)
            return end(Result::kFailed, "what answers there does not speak HTTP");
        const int status = std::atoi(line.substr(9, 3).c_str());
        if (status >= 200 && status < 300) return end(Result::kDelivered, {});
        // Too slow, too often: later.
        const bool later = status < 300 || status >= 500 || status == 408 || status == 425 || status == 429;
        verdict_ = later ? Result::kFailed : Result::kRefused;
        why_ = "it answered with status " + std::to_string(status);
        if (status < 400 && !later) why_ += ", another address" + new_server(head("location"));
        const int wait = std::atoi(head("retry-after").c_str());
        if (later && wait > 0)
            wait_ = std::min<Duration>(std::chrono::seconds(std::min(wait, 86'400)), kMaxWait);
        read_words();
    }

    /// The value of a head; its name in small letters.
    std::string head(std::string_view name) const {
        const auto heads = answer_.substr(0, answer_.find(kEndOfHeads));
        std::string small = heads;
        std::transform(small.begin(), small.end(), small.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        const auto at = small.find("\r\n" + std::string(name) + ":");
        if (at == std::string::npos) return {};
        const auto begin = heads.find_first_not_of(' ', at + name.size() + 3);
        return begin == std::string::npos ? std::string()
                                          : heads.substr(begin, heads.find('\r', begin) - begin);
    }

    /// The server alone: the rest may hold a key.
    static std::string new_server(const std::string& location) {
        const auto address = parse_webhook(location);
        return address ? ", at " + address->server.text() : std::string();
    }

    std::string_view body() const {
        const auto at = answer_.find(kEndOfHeads);
        return at == std::string::npos ? std::string_view{}
                                       : std::string_view(answer_).substr(at + kEndOfHeads.size());
    }

    /// What it says to its status, where that comes soon.
    void read_words() {
        const auto length = head("content-length");
        const std::size_t wanted =
            length.empty() ? kMaxWords
                           : std::min<std::size_t>(kMaxWords, std::strtoul(length.c_str(), nullptr, 10));
        if (body().size() >= wanted || answer_.find(kEndOfHeads) == std::string::npos)
            return end_by_verdict();
        const auto at_least = asio::transfer_at_least(wanted - body().size());
        auto buffer = asio::dynamic_buffer(answer_, kMaxAnswerBytes + kMaxWords);
        const auto received = [self = shared_from_this()](const Error&, std::size_t) {
            self->end_by_verdict();
        };
        tls_ ? asio::async_read(*tls_, buffer, at_least, received)
             : asio::async_read(socket_, buffer, at_least, received);
    }

    void end_by_verdict() {
        std::string words(body().substr(0, kMaxWords));
        std::replace_if(
            words.begin(), words.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; }, ' ');
        // Some say what was asked for, key and all.
        for (auto at = words.find(address_target_); address_target_.size() > 1 && at != std::string::npos;
             at = words.find(address_target_))
            words.replace(at, address_target_.size(), "...");
        end(*verdict_, why_ + (words.empty() ? "" : ": " + words));
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

    const text::HttpAddress address_;
    const std::string address_target_;
    const std::string request_;
    Done done_;
    bool ended_ = false;
    tcp::resolver resolver_;
    asio::steady_timer timer_;
    asio::ssl::context context_{asio::ssl::context::tls_client};
    tcp::socket socket_;
    std::optional<asio::ssl::stream<tcp::socket&>> tls_;
    std::string answer_;
    std::optional<Result> verdict_;  // of its status; its words may follow
    std::string why_;
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
