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
    const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    result.listener_ = Descriptor(listener);
    const int on = 1;
    ::setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* generic = reinterpret_cast<sockaddr*>(&address);
    if (listener < 0 || ::bind(listener, generic, size) != 0 || ::listen(listener, 4) != 0 ||
        ::getsockname(listener, generic, &size) != 0)
        return fail("cannot listen on 127.0.0.1:" + std::to_string(port) + ": " + std::strerror(errno));
    result.port_ = ntohs(address.sin_port);
    return result;
}

bool TcpPort::accept() {
    Descriptor arrived(::accept4(listener_.number(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!arrived.valid() || in_use()) return false;
    client_ = std::move(arrived);
    const int on = 1;
    ::setsockopt(client_.number(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return true;
}

std::string TcpPort::read(std::size_t max_bytes) {
    std::string bytes(max_bytes, '\0');
    const auto count = ::recv(client_.number(), bytes.data(), bytes.size(), 0);
    const bool nothing_yet = count < 0 && (errno == EAGAIN || errno == EINTR);
    if (count <= 0 && !nothing_yet) drop_client();
    bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    return bytes;
}

std::size_t TcpPort::write(std::string_view bytes) {
    const auto count = ::send(client_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    return count > 0 ? static_cast<std::size_t>(count) : 0;
}

void TcpPort::add_waits(std::vector<pollfd>& waits, bool with_bytes) const {
    if (is_open()) waits.push_back({listener_.number(), POLLIN, 0});
    if (in_use() && with_bytes) waits.push_back({client_.number(), POLLIN, 0});
}

}  // namespace asip::sim
