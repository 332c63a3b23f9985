// SPDX-License-Identifier: Apache-2.0
#include "cli/ask/http_request.hpp"

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <optional>

namespace asip::cli {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using ErrorCode = boost::system::error_code;

constexpr std::size_t kMaxHttpBytes = 64 * 1024;

std::string request_head(const char* method, const HttpAddress& address, const std::string& target,
                         const std::string& token) {
    return std::string(method) + " " + address.path + target + " HTTP/1.1\r\nHost: " + address.host_header() +
           "\r\nConnection: close\r\n" +
           (token.empty() ? std::string() : "Authorization: Bearer " + token + "\r\n");
}

Expected<HttpAnswer> parse_answer(const std::string& text) {
    const auto end = text.find("\r\n\r\n");
    if (!text.starts_with("HTTP/1.") || end == std::string::npos || text.size() < 12)
        return fail("what answered does not speak HTTP");
    HttpAnswer answer;
    answer.status = std::atoi(text.substr(9, 3).c_str());
    answer.body = text.substr(end + 4);
    return answer;
}

/// One request after the other steps: each is started, and the loop run until it is done or time is over.
class Exchange {
  public:
    Exchange(const HttpAddress& address, const std::string& ca, std::chrono::milliseconds limit)
        : address_(address), until_(std::chrono::steady_clock::now() + limit), socket_(io_) {
        if (!address.tls) return;
        if (ca.empty())
            context_.set_default_verify_paths(error_);
        else
            context_.load_verify_file(ca, error_);
        tls_.emplace(socket_, context_);
        tls_->set_verify_mode(asio::ssl::verify_peer);
        tls_->set_verify_callback(asio::ssl::host_name_verification(address.host));
        SSL_set_tlsext_host_name(tls_->native_handle(), address.host.c_str());
    }

    Expected<HttpAnswer> run(const std::string& request) {
        if (error_) return fail("--ca: " + error_.message());
        tcp::resolver resolver(io_);
        const auto found = resolver.resolve(address_.host, address_.port, error_);
        if (error_) return fail("cannot find " + address_.host + ": " + error_.message());
        if (!connect(found)) return fail("cannot reach " + address_.text() + ": " + error_.message());
        if (tls_) {
            tls_->async_handshake(asio::ssl::stream_base::client,
                                  [this](const ErrorCode& error) { done(error); });
            if (!wait()) return fail("no TLS with " + address_.text() + ": " + error_.message());
        }
        const auto sent = [this](const ErrorCode& error, std::size_t) { done(error); };
        if (tls_)
            asio::async_write(*tls_, asio::buffer(request), sent);
        else
            asio::async_write(socket_, asio::buffer(request), sent);
        if (!wait()) return fail("cannot write to " + address_.text() + ": " + error_.message());
        std::string text;
        while (read(text) && text.size() < kMaxHttpBytes) {
        }
        if (text.empty()) return fail(address_.text() + " gave no answer: " + error_.message());
        return parse_answer(text);
    }

  private:
    bool connect(const tcp::resolver::results_type& found) {
        for (const auto& entry : found) {
            ErrorCode ignored;
            socket_.close(ignored);
            socket_.async_connect(entry.endpoint(), [this](const ErrorCode& error) { done(error); });
            if (wait()) return true;
        }
        return false;
    }
    bool read(std::string& text) {
        const auto received = [this, &text](const ErrorCode& error, std::size_t bytes) {
            text.append(buffer_.data(), bytes);
            done(error);
        };
        if (tls_)
            tls_->async_read_some(asio::buffer(buffer_), received);
        else
            socket_.async_read_some(asio::buffer(buffer_), received);
        return wait();
    }
    void done(const ErrorCode& error) { result_ = error; }
    bool wait() {
        result_.reset();
        io_.restart();
        while (!result_ && io_.run_one_until(until_) > 0) {
        }
        if (!result_) {
            socket_.close(error_);
            io_.run();
            error_ = asio::error::timed_out;
            return false;
        }
        error_ = *result_;
        return !error_;
    }

    const HttpAddress& address_;
    std::chrono::steady_clock::time_point until_;
    ErrorCode error_;
    std::optional<ErrorCode> result_;
    asio::io_context io_;
    asio::ssl::context context_{asio::ssl::context::tls_client};
    tcp::socket socket_;
    std::optional<asio::ssl::stream<tcp::socket&>> tls_;
    std::array<char, 4096> buffer_{};
};

}  // namespace

Expected<HttpAnswer> http_get(const HttpAddress& address, const std::string& target,
                              const HttpAccess& access) {
    const auto head = request_head("GET", address, target, access.token);
    return Exchange(address, access.ca, access.limit).run(head + "\r\n");
}

Expected<HttpAnswer> http_post(const HttpAddress& address, const std::string& target,
                               const HttpAccess& access) {
    const auto head = request_head("POST", address, target, access.token);
    return Exchange(address, access.ca, access.limit)
        .run(head + "Content-Type: application/json\r\nContent-Length: 2\r\n\r\n{}");
}

}  // namespace asip::cli
