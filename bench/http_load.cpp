// SPDX-License-Identifier: Apache-2.0
#include "bench/http_load.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <unistd.h>

#include <charconv>
#include <stdexcept>
#include <utility>

namespace asip::bench {
namespace {

using Clock = std::chrono::steady_clock;

/// Size of the first answer in `text`; 0: it is not all there.
std::size_t answer_size(std::string_view text) {
    static constexpr std::string_view kLength = "Content-Length: ";
    const auto head = text.find("\r\n\r\n");
    if (head == text.npos) return 0;
    const auto at = text.substr(0, head).find(kLength);
    if (at == text.npos) throw std::runtime_error("an answer without its length");
    std::size_t length = 0;
    std::from_chars(text.data() + at + kLength.size(), text.data() + head, length);
    const auto size = head + 4 + length;
    return text.size() < size ? 0 : size;
}

void send_all(int socket, std::string_view text) {
    while (!text.empty()) {
        const auto sent = ::send(socket, text.data(), text.size(), MSG_NOSIGNAL);
        if (sent < 0) throw std::runtime_error("the connection was closed");
        text.remove_prefix(static_cast<std::size_t>(sent));
    }
}

void receive_more(int socket, std::string& text) {
    char buffer[65536];
    const auto count = ::recv(socket, buffer, sizeof buffer, 0);
    if (count <= 0) throw std::runtime_error("the connection was closed");
    text.append(buffer, static_cast<std::size_t>(count));
}

class Run {
  public:
    explicit Run(const Load& load) : load_(load), epoll_(epoll_create1(0)) {
        for (int i = 0; i < load.connections; ++i) {
            peers_.push_back({connect_to(load.port), {}, {}});
            epoll_event event{.events = EPOLLIN, .data = {.u64 = static_cast<std::uint64_t>(i)}};
            epoll_ctl(epoll_, EPOLL_CTL_ADD, peers_.back().socket, &event);
            idle_.push_back(static_cast<std::size_t>(i));
        }
    }
    ~Run() {
        for (const auto& peer : peers_)
            close(peer.socket);
        close(epoll_);
    }
    Run(const Run&) = delete;
    Run& operator=(const Run&) = delete;

    Answers result() {
        const auto begin = Clock::now();
        const auto end = begin + load_.time;
        due_ = begin;
        while (Clock::now() < end) {
            send_due();
            receive();
        }
        result_.per_second = static_cast<double>(result_.milliseconds.size()) /
                             std::chrono::duration<double>(Clock::now() - begin).count();
        return std::move(result_);
    }

  private:
    struct Peer {
        int socket;
        Clock::time_point since;
        std::string text;
    };

    void send_due() {
        const auto now = Clock::now();
        const std::chrono::nanoseconds step(load_.per_second > 0 ? static_cast<long>(1e9 / load_.per_second)
                                                                 : 0);
        while (!idle_.empty() && due_ <= now) {
            auto& peer = peers_[idle_.back()];
            idle_.pop_back();
            peer.since = step.count() ? due_ : now;
            due_ += step;
            send_all(peer.socket, load_.request);
        }
    }

    void receive() {
        epoll_event events[64];
        const auto until_due = due_ - Clock::now();
        timespec wait{0, 1'000'000};
        if (load_.per_second > 0 && !idle_.empty() && until_due < std::chrono::milliseconds(1))
            wait.tv_nsec = std::max<long>(0, std::chrono::nanoseconds(until_due).count());
        const int count = epoll_pwait2(epoll_, events, 64, &wait, nullptr);
        for (int i = 0; i < count; ++i) {
            auto& peer = peers_[events[i].data.u64];
            receive_more(peer.socket, peer.text);
            const auto size = answer_size(peer.text);
            if (size == 0) continue;
            peer.text.erase(0, size);
            using Milliseconds = std::chrono::duration<double, std::milli>;
            result_.milliseconds.push_back(Milliseconds(Clock::now() - peer.since).count());
            idle_.push_back(events[i].data.u64);
        }
    }

    const Load& load_;
    int epoll_;
    std::vector<Peer> peers_;
    std::vector<std::size_t> idle_;
    Clock::time_point due_;
    Answers result_;
};

}  // namespace

int connect_to(std::uint16_t port) {
    const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
    const int on = 1;
    setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
        close(socket);
        throw std::runtime_error("no connection to port " + std::to_string(port));
    }
    return socket;
}

std::string http_request(std::string_view method, std::string_view target, std::string_view body) {
    std::string text(method);
    text.append(" ").append(target).append(" HTTP/1.1\r\nHost: 127.0.0.1\r\n");
    if (method != "GET")
        text += "Content-Type: application/json\r\nContent-Length: " + std::to_string(body.size()) + "\r\n";
    return text.append("\r\n").append(body);
}

HttpConnection::~HttpConnection() {
    close(socket_);
}

std::string HttpConnection::ask(std::string_view request) {
    send_all(socket_, request);
    std::string text;
    while (answer_size(text) == 0)
        receive_more(socket_, text);
    if (!text.starts_with("HTTP/1.1 200 ")) return {};
    return text.substr(text.find("\r\n\r\n") + 4);
}

Answers run(const Load& load) {
    return Run(load).result();
}

}  // namespace asip::bench
