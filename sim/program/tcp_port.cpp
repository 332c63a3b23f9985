// SPDX-License-Identifier: Apache-2.0
#include "sim/program/tcp_port.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace asip::sim {

Expected<TcpPort> TcpPort::listen(int port) {
    TcpPort result;
    result.listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    const int on = 1;
    ::setsockopt(result.listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* generic = reinterpret_cast<sockaddr*>(&address);
    if (result.listener_ < 0 || ::bind(result.listener_, generic, size) != 0 ||
        ::listen(result.listener_, 4) != 0 || ::getsockname(result.listener_, generic, &size) != 0)
        return fail("cannot listen on 127.0.0.1:" + std::to_string(port) + ": " + std::strerror(errno));
    result.port_ = ntohs(address.sin_port);
    return result;
}

TcpPort::~TcpPort() {
    drop_client();
    if (listener_ >= 0) ::close(listener_);
}

TcpPort::TcpPort(TcpPort&& other) noexcept
    : listener_(std::exchange(other.listener_, -1)),
      client_(std::exchange(other.client_, -1)),
      port_(other.port_) {}

TcpPort& TcpPort::operator=(TcpPort&& other) noexcept {
    std::swap(listener_, other.listener_);
    std::swap(client_, other.client_);
    std::swap(port_, other.port_);
    return *this;
}

bool TcpPort::accept() {
    const int arrived = ::accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (arrived < 0) return false;
    if (client_ >= 0) {
        ::close(arrived);
        return false;
    }
    client_ = arrived;
    const int on = 1;
    ::setsockopt(client_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return true;
}

std::string TcpPort::read(std::size_t max_bytes) {
    std::string bytes(max_bytes, '\0');
    const auto count = ::recv(client_, bytes.data(), bytes.size(), 0);
    const bool nothing_yet = count < 0 && (errno == EAGAIN || errno == EINTR);
    if (count <= 0 && !nothing_yet) drop_client();
    bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    return bytes;
}

std::size_t TcpPort::write(std::string_view bytes) {
    const auto count = ::send(client_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    return count > 0 ? static_cast<std::size_t>(count) : 0;
}

void TcpPort::add_waits(std::vector<pollfd>& waits, bool with_bytes) const {
    if (listener_ >= 0) waits.push_back({listener_, POLLIN, 0});
    if (client_ >= 0 && with_bytes) waits.push_back({client_, POLLIN, 0});
}

void TcpPort::drop_client() {
    if (client_ >= 0) ::close(client_);
    client_ = -1;
}

}  // namespace asip::sim
