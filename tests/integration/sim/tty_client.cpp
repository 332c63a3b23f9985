// SPDX-License-Identifier: Apache-2.0
#include "tty_client.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <utility>

namespace asip::test {
namespace {

speed_t speed_of(int baud) {
    switch (baud) {
        case 9600:
            return B9600;
        case 57600:
            return B57600;
        case 115200:
            return B115200;
        case 500000:
            return B500000;
        case 1000000:
            return B1000000;
        default:
            throw std::runtime_error("no such rate in this test");
    }
}

}  // namespace

StreamClient StreamClient::terminal(const std::string& path, int baud) {
    const int descriptor = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) throw std::runtime_error("cannot open " + path);
    termios settings{};
    tcgetattr(descriptor, &settings);
    cfmakeraw(&settings);
    tcsetattr(descriptor, TCSANOW, &settings);
    StreamClient client(descriptor);
    client.set_baud(baud);
    return client;
}

StreamClient StreamClient::tcp(int port) {
    const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(descriptor, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
        throw std::runtime_error("cannot connect to port " + std::to_string(port));
    fcntl(descriptor, F_SETFL, O_NONBLOCK);
    return StreamClient(descriptor);
}

StreamClient StreamClient::unix_socket(const std::string& path) {
    const int descriptor = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    if (::connect(descriptor, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
        throw std::runtime_error("cannot connect to " + path);
    fcntl(descriptor, F_SETFL, O_NONBLOCK);
    return StreamClient(descriptor);
}

StreamClient::StreamClient(StreamClient&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      closed_(other.closed_),
      received_(std::move(other.received_)) {}

StreamClient::~StreamClient() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

void StreamClient::set_baud(int baud) {
    termios settings{};
    tcgetattr(descriptor_, &settings);
    cfsetspeed(&settings, speed_of(baud));
    tcsetattr(descriptor_, TCSANOW, &settings);
}

void StreamClient::write(std::string_view bytes) {
    while (!bytes.empty()) {
        const auto count = ::write(descriptor_, bytes.data(), bytes.size());
        if (count > 0) {
            bytes.remove_prefix(static_cast<std::size_t>(count));
            continue;
        }
        pollfd writable{descriptor_, POLLOUT, 0};
        if (errno != EAGAIN || ::poll(&writable, 1, static_cast<int>(kDeadline.count())) != 1)
            throw std::runtime_error("cannot write");
    }
}

void StreamClient::read() {
    char bytes[4096];
    ssize_t count = 0;
    while ((count = ::read(descriptor_, bytes, sizeof bytes)) > 0)
        received_.append(bytes, static_cast<std::size_t>(count));
    pollfd state{descriptor_, POLLIN, 0};
    ::poll(&state, 1, 0);
    if ((state.revents & POLLHUP) != 0 || (count == 0 && (state.revents & POLLIN) != 0) ||
        (count < 0 && errno != EAGAIN))
        closed_ = true;
}

const std::string& StreamClient::received() {
    read();
    return received_;
}

bool StreamClient::expect(std::string_view text, std::chrono::milliseconds limit) {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    for (;;) {
        read();
        const auto found = received_.find(text);
        if (found != std::string::npos) {
            received_.erase(0, found + text.size());
            return true;
        }
        const auto left = deadline - std::chrono::steady_clock::now();
        if (closed_ || left <= std::chrono::nanoseconds(0)) return false;
        pollfd readable{descriptor_, POLLIN, 0};
        ::poll(&readable, 1, static_cast<int>(left / std::chrono::milliseconds(1)) + 1);
    }
}

bool StreamClient::closed() {
    read();
    return closed_;
}

}  // namespace asip::test
