// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/transport.hpp"

#include <sys/socket.h>

#include <boost/asio/bind_executor.hpp>
#include <utility>

#include "gateway/http/connection.hpp"
#include "gateway/http/turn_executor.hpp"

namespace asip::gateway::http {

void Transport::close() {
    ErrorCode ignored;
    socket_->shutdown(Socket::shutdown_both, ignored);
    socket_->close(ignored);
}

void Transport::read_some(boost::asio::mutable_buffer buffer, Ended ended) {
    if (tls_) return tls_->async_read_some(buffer, std::move(ended));
    socket_->async_read_some(buffer, std::move(ended));
}

void Transport::write_some(const std::array<boost::asio::const_buffer, kBuffers>& buffers, Ended ended) {
    if (tls_) return tls_->async_write_some(buffers, std::move(ended));
    socket_->async_write_some(buffers, std::move(ended));
}

namespace asio = boost::asio;

void Connection::start(asio::ssl::context* tls) {
    until(shared_->limits.head_time);
    if (tls == nullptr) {
        phase_ = Phase::kReading;
        return read();
    }
    if (use_ != nullptr && use_->handshakes >= shared_->limits.handshakes_per_address) {
        ++shared_->counters.turned_away;
        return close();
    }
    shakes_hands(true);
    transport_.socket().async_wait(Transport::Socket::wait_read, [self = shared_from_this(), tls](
                                                                     const boost::system::error_code& error) {
        if (self->closed()) return;
        if (error) return self->close();
        char first = 0;
        ::recv(self->transport_.socket().native_handle(), &first, 1, MSG_PEEK | MSG_DONTWAIT);
        if (first < 'A' || first > 'Z') return self->handshake(*tls);
        // The method of a request: this browser was given http:, and not https:.
        self->shakes_hands(false);
        self->phase_ = Phase::kReading;
        self->read();
    });
}

void Connection::handshake(asio::ssl::context& tls) {
    transport_.use_tls(tls);
    // A handshake costs a millisecond or two, and comes before any token.
    const TurnExecutor turns(asio::query(transport_.get_executor(), asio::execution::context),
                             shared_->shares, "address " + address_);
    transport_.tls()->async_handshake(
        asio::ssl::stream_base::server,
        asio::bind_executor(turns, [self = shared_from_this()](const boost::system::error_code& error) {
            if (self->closed()) return;
            self->shakes_hands(false);
            if (error) return self->close();
            self->phase_ = Phase::kReading;
            self->read();
        }));
}

void Connection::shakes_hands(bool now) {
    if (use_ == nullptr || std::exchange(in_handshake_, now) == now) return;
    use_->handshakes += now ? 1 : -1;
}

}  // namespace asip::gateway::http
