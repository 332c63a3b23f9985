// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/transport.hpp"

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

}  // namespace asip::gateway::http
