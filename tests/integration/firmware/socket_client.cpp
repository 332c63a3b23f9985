// SPDX-License-Identifier: Apache-2.0
#include "socket_client.hpp"

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>

namespace asip::firmware {

int SocketClient::connect(const char* host, std::uint16_t port) {
    stop();
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    if (inet_pton(AF_INET, host, &address.sin_addr) != 1) return 0;
    socket_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
        stop();
        return 0;
    }
    const int on = 1;
    setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return 1;
}

std::size_t SocketClient::write(const std::uint8_t* bytes, std::size_t size) {
    const auto sent = socket_ < 0 ? -1 : send(socket_, bytes, size, MSG_NOSIGNAL);
    return sent < 0 ? 0 : static_cast<std::size_t>(sent);
}

void SocketClient::receive() {
    std::array<char, 4096> bytes{};
    while (socket_ >= 0 && !ended_) {
        const auto got = recv(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT);
        if (got < 0) return;
        if (got == 0) ended_ = true;
        received_.append(bytes.data(), static_cast<std::size_t>(got));
    }
}

int SocketClient::available() {
    receive();
    return static_cast<int>(received_.size());
}

int SocketClient::read() {
    if (available() == 0) return -1;
    const auto byte = static_cast<unsigned char>(received_.front());
    received_.erase(0, 1);
    return byte;
}

void SocketClient::stop() {
    if (socket_ >= 0) close(socket_);
    socket_ = -1;
    ended_ = false;
    received_.clear();
}

std::uint8_t SocketClient::connected() {
    return available() > 0 || (socket_ >= 0 && !ended_) ? 1 : 0;
}

}  // namespace asip::firmware
