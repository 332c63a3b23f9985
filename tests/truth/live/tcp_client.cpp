// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/live/tcp_client.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <utility>

namespace truth {

namespace session = asip::session;

TcpClient::~TcpClient() {
    if (socket_ >= 0) close(socket_);
}

bool TcpClient::submit(const std::string& line, asip::Duration deadline, Ended ended) {
    const auto now = asip::Clock::now();
    session::RequestOptions options;
    options.deadline = now + deadline;
    session::Actions actions;
    const auto id = session_.submit(line, options, now, actions);
    if (id) open_[*id] = std::move(ended);
    perform(actions);
    return id.has_value();
}

void TcpClient::open() {
    const auto now = asip::Clock::now();
    if (now < retry_) return;
    retry_ = now + std::chrono::milliseconds(200);
    const int opened = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port_);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(opened, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
        close(opened);
        return;
    }
    fcntl(opened, F_SETFL, O_NONBLOCK);
    socket_ = opened;
    session::Actions actions;
    session_.link_up({}, now, actions);
    perform(actions);
}

void TcpClient::lose() {
    close(std::exchange(socket_, -1));
    to_send_.clear();
    session::Actions actions;
    session_.link_down(asip::Clock::now(), actions);
    perform(actions);
}

void TcpClient::pump() {
    if (socket_ < 0) return open();
    char buffer[4096];
    for (;;) {
        const auto count = recv(socket_, buffer, sizeof buffer, 0);
        if (count == 0 || (count < 0 && errno != EAGAIN)) return lose();
        if (count < 0) break;
        session::Actions actions;
        session_.receive({buffer, static_cast<std::size_t>(count)}, asip::Clock::now(), actions);
        perform(actions);
    }
    if (const auto deadline = session_.next_deadline(); deadline && *deadline <= asip::Clock::now()) {
        session::Actions actions;
        session_.tick(asip::Clock::now(), actions);
        perform(actions);
    }
    if (to_send_.empty()) return;
    const auto sent = send(socket_, to_send_.data(), to_send_.size(), MSG_NOSIGNAL);
    if (sent > 0) to_send_.erase(0, static_cast<std::size_t>(sent));
}

void TcpClient::perform(session::Actions& actions) {
    for (const auto& action : actions) {
        if (const auto* write = std::get_if<session::Write>(&action)) to_send_ += write->bytes;
        if (const auto* end = std::get_if<session::Finished>(&action)) {
            const auto known = open_.extract(end->id);
            if (!known.empty()) known.mapped()(*end);
        }
    }
}

}  // namespace truth
