// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/server.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/basic_socket_acceptor.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <stdexcept>

#include "gateway/http/address.hpp"
#include "gateway/http/connection.hpp"

namespace asip::gateway::http {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using ErrorCode = boost::system::error_code;
using Protocol = asio::generic::stream_protocol;
using Acceptor = asio::basic_socket_acceptor<Protocol>;

constexpr Duration kSweep = std::chrono::milliseconds(250);
constexpr std::string_view kUnix = "unix:";
constexpr std::string_view kTooMany =
    R"({"title":"Service Unavailable","status":503,"detail":"too many connections; try later"})";

[[noreturn]] void cannot(const std::string& address, const std::string& why) {
    throw std::runtime_error("cannot listen on " + address + ": " + why);
}

tcp::endpoint parse_address(const std::string& text) {
    const auto colon = text.rfind(':');
    if (colon == std::string::npos) cannot(text, "write ADDRESS:PORT");
    std::string host = text.substr(0, colon);
    if (host.size() > 1 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
    ErrorCode error;
    const auto address = asio::ip::make_address(host, error);
    int port = -1;
    const auto digits = text.substr(colon + 1);
    if (!digits.empty() && digits.size() < 6 && digits.find_first_not_of("0123456789") == std::string::npos)
        port = std::stoi(digits);
    if (error) cannot(text, "\"" + host + "\" is not an IP address");
    if (port < 0 || port > 65535) cannot(text, "\"" + digits + "\" is not a port");
    return {address, static_cast<std::uint16_t>(port)};
}

std::string shown(const tcp::endpoint& endpoint) {
    const auto host = endpoint.address().to_string();
    const auto port = std::to_string(endpoint.port());
    return endpoint.address().is_v6() ? "[" + host + "]:" + port : host + ":" + port;
}

tcp::endpoint tcp_endpoint(const Protocol::endpoint& generic) {
    tcp::endpoint result;
    std::memcpy(result.data(), generic.data(), std::min(generic.size(), result.capacity()));
    return result;
}

}  // namespace

class Server::Impl : public std::enable_shared_from_this<Impl> {
  public:
    Impl(asio::io_context& io, Options options, bus::Shares& shares, AskerOf asker_of, Handler handler)
        : io_(io), shared_(std::make_shared<Shared>(shares)), timer_(io) {
        shared_->asker_of = std::move(asker_of);
        shared_->handler = std::move(handler);
        shared_->limits = options.limits;
        if (options.tls) use_tls(*options.tls);
        for (const auto& address : options.addresses)
            listen(address);
    }

    ~Impl() {
        for (const auto& path : unix_paths_)
            unlink(path.c_str());
    }

    void start() {
        for (auto& acceptor : acceptors_)
            accept(acceptor);
        sweep();
    }

    void stop() {
        ErrorCode ignored;
        for (auto& acceptor : acceptors_)
            acceptor.close(ignored);
        timer_.cancel();
        for (auto& connection : std::exchange(connections_, {}))
            connection->leave();
    }

    std::vector<std::string> addresses() const { return addresses_; }
    ServerCounters counters() const { return shared_->counters; }

  private:
    void use_tls(const Tls& tls) {
        tls_ = std::make_unique<asio::ssl::context>(asio::ssl::context::tls_server);
        tls_->set_options(asio::ssl::context::no_tlsv1 | asio::ssl::context::no_tlsv1_1 |
                          asio::ssl::context::single_dh_use | SSL_OP_NO_RENEGOTIATION);
        SSL_CTX_set_mode(tls_->native_handle(), SSL_MODE_RELEASE_BUFFERS);
        ErrorCode error;
        tls_->use_certificate_chain_file(tls.cert_file, error);
        if (error) throw std::runtime_error("cannot use " + tls.cert_file + ": " + error.message());
        tls_->use_private_key_file(tls.key_file, asio::ssl::context::pem, error);
        if (error) throw std::runtime_error("cannot use " + tls.key_file + ": " + error.message());
    }

    void listen(const std::string& address) {
        const bool local = address.starts_with(kUnix);
        Protocol::endpoint endpoint;
        if (local) {
            const auto path = address.substr(kUnix.size());
            struct stat found{};
            if (stat(path.c_str(), &found) == 0 && S_ISSOCK(found.st_mode)) unlink(path.c_str());
            endpoint = asio::local::stream_protocol::endpoint(path);
            unix_paths_.push_back(path);
        } else {
            endpoint = parse_address(address);
        }
        Acceptor acceptor(io_);
        ErrorCode error;
        acceptor.open(endpoint.protocol(), error);
        if (!error && !local) acceptor.set_option(asio::socket_base::reuse_address(true), error);
        if (!error) acceptor.bind(endpoint, error);
        if (!error) acceptor.listen(4096, error);
        if (error) cannot(address, error.message());
        addresses_.push_back(local ? address : shown(tcp_endpoint(acceptor.local_endpoint())));
        acceptors_.push_back(std::move(acceptor));
    }

    void accept(Acceptor& acceptor) {
        acceptor.async_accept(
            [self = shared_from_this(), &acceptor](const ErrorCode& error, Protocol::socket socket) {
                if (error == asio::error::operation_aborted || !acceptor.is_open()) return;
                if (error) return self->pause(acceptor);
                self->accepted(std::move(socket));
                self->accept(acceptor);
            });
    }

    // Probably no descriptor is left: one becomes free when a connection ends.
    void pause(Acceptor& acceptor) {
        auto timer = std::make_shared<asio::steady_timer>(io_, std::chrono::milliseconds(100));
        timer->async_wait([self = shared_from_this(), &acceptor, timer](const ErrorCode& error) {
            if (!error && acceptor.is_open()) self->accept(acceptor);
        });
    }

    /// A peer that vanished without a word is gone within a minute: nothing that was sent is acknowledged,
    /// or, where nothing is sent, no probe. Without that the kernel tries for a quarter of an hour.
    static void notice_vanished(int socket) {
        constexpr int kOn = 1;
        constexpr unsigned kUnacknowledgedMs = 60'000;
        constexpr int kIdleSeconds = 30, kProbeSeconds = 10, kProbes = 3;
        setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &kOn, sizeof kOn);
        setsockopt(socket, SOL_SOCKET, SO_KEEPALIVE, &kOn, sizeof kOn);
        setsockopt(socket, IPPROTO_TCP, TCP_KEEPIDLE, &kIdleSeconds, sizeof kIdleSeconds);
        setsockopt(socket, IPPROTO_TCP, TCP_KEEPINTVL, &kProbeSeconds, sizeof kProbeSeconds);
        setsockopt(socket, IPPROTO_TCP, TCP_KEEPCNT, &kProbes, sizeof kProbes);
        setsockopt(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, &kUnacknowledgedMs, sizeof kUnacknowledgedMs);
    }

    void accepted(Protocol::socket socket) {
        ++shared_->counters.accepted;
        ErrorCode error;
        const auto endpoint = socket.remote_endpoint(error);
        if (error) return;
        Peer peer;
        peer.secure = tls_ != nullptr;
        const int family = endpoint.data()->sa_family;
        if (family == AF_INET || family == AF_INET6) {
            const auto address = tcp_endpoint(endpoint).address();
            peer.address = address.to_string();
            peer.loopback = address.is_loopback();
            notice_vanished(socket.native_handle());
        }
        socket.non_blocking(true, error);
        const bool of_proxy = shared_->limits.behind_proxy && (peer.loopback || peer.address.empty());
        const auto address = of_proxy ? std::string() : network_of(peer.address);
        const auto others = shared_->addresses.find(address);  // looked up only: a table of strangers would
                                                               // grow
        if (shared_->counters.open >= shared_->limits.connections ||
            (others != shared_->addresses.end() &&
             others->second.connections >= shared_->limits.connections_per_address)) {
            ++shared_->counters.turned_away;
            if (!tls_) socket.send(asio::buffer(too_many_), 0, error);
            return;
        }
        auto connection = std::make_shared<Connection>(shared_, Transport(std::move(socket)), peer, address);
        connections_.push_back(connection);
        connection->start(tls_.get());
    }

    void sweep() {
        const Time now = Clock::now();
        for (std::size_t i = 0; i < connections_.size();) {
            connections_[i]->sweep(now);
            if (!connections_[i]->closed()) {
                ++i;
                continue;
            }
            connections_[i] = std::move(connections_.back());
            connections_.pop_back();
        }
        timer_.expires_after(kSweep);
        timer_.async_wait([self = shared_from_this()](const ErrorCode& error) {
            if (!error) self->sweep();
        });
    }

    asio::io_context& io_;
    std::shared_ptr<Shared> shared_;
    asio::steady_timer timer_;
    std::unique_ptr<asio::ssl::context> tls_;
    std::vector<Acceptor> acceptors_;
    std::vector<std::string> addresses_;
    std::vector<std::string> unix_paths_;
    std::vector<std::shared_ptr<Connection>> connections_;
    const std::string too_many_ = [] {
        Response response;
        response.status = 503;
        response.content_type = "application/problem+json";
        response.headers = {{"Retry-After", "5"}};
        response.body = kTooMany;
        return head_text(response, false, false) + response.body;
    }();
};

Server::Server(asio::io_context& io, Options options, bus::Shares& shares, AskerOf asker_of, Handler handler)
    : impl_(std::make_shared<Impl>(io, std::move(options), shares, std::move(asker_of), std::move(handler))) {
}

Server::~Server() {
    impl_->stop();
}

void Server::start() {
    impl_->start();
}

void Server::stop() {
    impl_->stop();
}

std::vector<std::string> Server::addresses() const {
    return impl_->addresses();
}

ServerCounters Server::counters() const {
    return impl_->counters();
}

}  // namespace asip::gateway::http
