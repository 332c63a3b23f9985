// SPDX-License-Identifier: Apache-2.0
#include "asip/link/tcp_stream.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <charconv>

#include "asip/link/stream_base.hpp"

namespace asip::link {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using Kind = StreamError::Kind;

std::string url(const TcpAddress& address) {
    const bool v6 = address.host.find(':') != std::string::npos;
    return "tcp://" + (v6 ? "[" + address.host + "]" : address.host) + ":" + std::to_string(address.port);
}

/// The kernel asks a silent peer after 4 s, then each 2 s, and gives up after three questions (RFC 1122,
/// 4.2.3.6); bytes that are not acknowledged for 10 s end the connection, too (RFC 5482).
void notice_vanished_peer(tcp::socket& socket) {
    const int fd = socket.native_handle();
    const auto set = [fd](int level, int option, int value) {
        (void)setsockopt(fd, level, option, &value, sizeof value);
    };
    set(SOL_SOCKET, SO_KEEPALIVE, 1);
    set(IPPROTO_TCP, TCP_KEEPIDLE, 4);
    set(IPPROTO_TCP, TCP_KEEPINTVL, 2);
    set(IPPROTO_TCP, TCP_KEEPCNT, 3);
    set(IPPROTO_TCP, TCP_USER_TIMEOUT, 10'000);
}

std::unique_ptr<ByteStream> make_stream(tcp::socket socket, std::string name) {
    boost::system::error_code ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    notice_vanished_peer(socket);
    socket.non_blocking(true, ignored);
    return std::make_unique<CoreStream<tcp::socket>>(std::move(socket), std::move(name));
}

class Attempt : public std::enable_shared_from_this<Attempt> {
  public:
    Attempt(asio::io_context& io, TcpAddress address, TcpConnectHandler done)
        : address_(std::move(address)), done_(std::move(done)), resolver_(io), socket_(io), timer_(io) {}

    void start(Duration timeout) {
        timer_.expires_after(timeout);
        timer_.async_wait([self = shared_from_this()](const boost::system::error_code& error) {
            if (!error) self->finish_with("no answer");
        });
        resolver_.async_resolve(address_.host, std::to_string(address_.port),
                                [self = shared_from_this()](const boost::system::error_code& error,
                                                            const tcp::resolver::results_type& results) {
                                    if (error)
                                        self->finish_with("unknown host", Kind::kNotThere);
                                    else
                                        self->connect(results);
                                });
    }

    void cancel() {
        done_ = nullptr;
        timer_.cancel();
        resolver_.cancel();
        boost::system::error_code ignored;
        socket_.close(ignored);
    }

  private:
    void connect(const tcp::resolver::results_type& results) {
        if (!done_) return;
        asio::async_connect(
            socket_, results,
            [self = shared_from_this()](const boost::system::error_code& error, const tcp::endpoint&) {
                if (error)
                    self->finish_with(error.message());
                else
                    self->finish_connected();
            });
    }

    void finish_connected() {
        if (!done_) return;
        const auto done = std::move(done_);
        auto stream = make_stream(std::move(socket_), url(address_));
        cancel();
        done(std::move(stream));
    }

    void finish_with(const std::string& reason, Kind kind = Kind::kUnreachable) {
        if (!done_) return;
        const auto done = std::move(done_);
        cancel();
        done(
            Unexpected<StreamError>(StreamError{kind, "cannot connect to " + url(address_) + ": " + reason}));
    }

    TcpAddress address_;
    TcpConnectHandler done_;
    tcp::resolver resolver_;
    tcp::socket socket_;
    asio::steady_timer timer_;
};

/// Held by the caller; destroying it abandons the attempt.
struct AttemptHandle {
    std::shared_ptr<Attempt> attempt;
    ~AttemptHandle() { attempt->cancel(); }
};

class Acceptor : public std::enable_shared_from_this<Acceptor> {
  public:
    Acceptor(asio::io_context& io, TcpAcceptHandler accepted)
        : acceptor_(io), pause_(io), accepted_(std::move(accepted)) {}

    boost::system::error_code open(const tcp::endpoint& endpoint) {
        boost::system::error_code error;
        acceptor_.open(endpoint.protocol(), error);
        if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
        if (!error) acceptor_.bind(endpoint, error);
        if (!error) acceptor_.listen(tcp::acceptor::max_listen_connections, error);
        return error;
    }
    std::uint16_t port() const {
        boost::system::error_code ignored;
        return acceptor_.local_endpoint(ignored).port();
    }
    void accept() {
        acceptor_.async_accept(
            [self = shared_from_this()](const boost::system::error_code& error, tcp::socket socket) {
                if (!self->acceptor_.is_open()) return;
                if (error) {
                    self->accept_later();
                    return;
                }
                boost::system::error_code gone;
                const auto peer = socket.remote_endpoint(gone);
                if (!gone) {
                    self->accepted_(
                        make_stream(std::move(socket), url({peer.address().to_string(), peer.port()})));
                }
                if (self->acceptor_.is_open()) self->accept();
            });
    }
    void close() {
        boost::system::error_code ignored;
        acceptor_.close(ignored);
        pause_.cancel();
    }

  private:
    /// Out of file descriptors, most likely: trying again at once would only use up the processor.
    void accept_later() {
        pause_.expires_after(std::chrono::milliseconds(100));
        pause_.async_wait([self = shared_from_this()](const boost::system::error_code& error) {
            if (!error && self->acceptor_.is_open()) self->accept();
        });
    }

    tcp::acceptor acceptor_;
    asio::steady_timer pause_;
    TcpAcceptHandler accepted_;
};

class Listener final : public TcpListener {
  public:
    explicit Listener(std::shared_ptr<Acceptor> acceptor) : acceptor_(std::move(acceptor)) {}
    ~Listener() override { acceptor_->close(); }
    std::uint16_t port() const override { return acceptor_->port(); }

  private:
    std::shared_ptr<Acceptor> acceptor_;
};

}  // namespace

Expected<TcpAddress> parse_tcp_address(std::string_view text, std::string_view default_host) {
    const std::string given(text);
    if (text.starts_with("tcp://")) text.remove_prefix(6);
    auto host = std::string_view{};
    auto port = text;
    if (const auto colon = text.rfind(':'); colon != std::string_view::npos) {
        host = text.substr(0, colon);
        port = text.substr(colon + 1);
    }
    if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
    if (host.empty()) host = default_host;
    unsigned number = 0;
    const auto [end, problem] = std::from_chars(port.data(), port.data() + port.size(), number);
    const bool is_port = problem == std::errc{} && end == port.data() + port.size() && number <= 65535;
    if (host.empty() || !is_port)
        return fail("\"" + given + "\" is not " + (default_host.empty() ? "HOST:PORT" : "PORT or HOST:PORT"));
    return TcpAddress{std::string(host), static_cast<std::uint16_t>(number)};
}

std::shared_ptr<void> connect_tcp(asio::io_context& io, const TcpAddress& address, Duration timeout,
                                  TcpConnectHandler done) {
    auto attempt = std::make_shared<Attempt>(io, address, std::move(done));
    attempt->start(timeout);
    return std::shared_ptr<AttemptHandle>(new AttemptHandle{std::move(attempt)});
}

Expected<std::unique_ptr<TcpListener>, StreamError> listen_tcp(asio::io_context& io,
                                                               const TcpAddress& address,
                                                               TcpAcceptHandler accepted) {
    tcp::resolver resolver(io);
    boost::system::error_code error;
    const auto results =
        resolver.resolve(address.host, std::to_string(address.port), tcp::resolver::passive, error);
    if (error || results.empty()) {
        return Unexpected<StreamError>(
            StreamError{Kind::kNotThere, "cannot listen on " + url(address) + ": unknown host"});
    }
    auto acceptor = std::make_shared<Acceptor>(io, std::move(accepted));
    error = acceptor->open(results.begin()->endpoint());
    if (error) {
        const auto kind = error == asio::error::address_in_use  ? Kind::kBusy
                          : error == asio::error::access_denied ? Kind::kNoPermission
                                                                : Kind::kFailed;
        return Unexpected<StreamError>(
            StreamError{kind, "cannot listen on " + url(address) + ": " + error.message()});
    }
    acceptor->accept();
    return std::make_unique<Listener>(std::move(acceptor));
}

}  // namespace asip::link
