// SPDX-License-Identifier: Apache-2.0
#include "http_client.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <stdexcept>

namespace asip::test {
namespace {

std::chrono::steady_clock::time_point after(std::chrono::milliseconds limit) {
    return std::chrono::steady_clock::now() + limit;
}

std::string lower(std::string text) {
    for (char& c : text)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

HttpAnswer read_head(Wire& wire, std::chrono::milliseconds limit) {
    HttpAnswer answer;
    auto head = wire.read_until("\r\n\r\n", limit);
    if (head.size() < 12) return answer;
    answer.status = std::stoi(head.substr(9, 3));
    for (auto at = head.find("\r\n"); at + 2 < head.size();) {
        const auto end = head.find("\r\n", at + 2);
        const auto line = head.substr(at + 2, end - at - 2);
        const auto colon = line.find(": ");
        at = end;
        if (colon == std::string::npos) continue;
        auto& value = answer.headers[lower(line.substr(0, colon))];
        value += (value.empty() ? "" : ", ") + line.substr(colon + 2);  // of one that is repeated both count
    }
    return answer;
}

std::string request_text(const std::string& method, const std::string& target, const std::string& body,
                         const Headers& headers) {
    std::string text = method + " " + target + " HTTP/1.1\r\n";
    bool host = false, type = false;
    for (const auto& [name, value] : headers) {
        text += name + ": " + value + "\r\n";
        host |= lower(name) == "host";
        type |= lower(name) == "content-type";
    }
    if (!host) text += "Host: localhost\r\n";
    if (method == "POST" && !type) text += "Content-Type: application/json\r\n";
    if (!body.empty()) text += "Content-Length: " + std::to_string(body.size()) + "\r\n";
    return text + "\r\n" + body;
}

}  // namespace

Wire::Wire(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
        throw std::runtime_error("cannot connect to port " + std::to_string(port));
}

Wire::~Wire() {
    if (socket_ >= 0) close(socket_);
}

bool Wire::send(std::string_view bytes) {
    while (!bytes.empty()) {
        const auto sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent <= 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
}

bool Wire::receive(std::chrono::steady_clock::time_point until) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now())
            .count();
    pollfd waiting{socket_, POLLIN, 0};
    if (left < 0 || poll(&waiting, 1, static_cast<int>(left)) <= 0) return false;
    char buffer[16384];
    const auto received = recv(socket_, buffer, sizeof buffer, 0);
    ended_ = received <= 0;
    if (ended_) return false;
    in_.append(buffer, static_cast<std::size_t>(received));
    return true;
}

std::string Wire::read_until(std::string_view until, std::chrono::milliseconds limit) {
    const auto end = after(limit);
    for (;;) {
        const auto at = in_.find(until);
        if (at != std::string::npos) {
            auto text = in_.substr(0, at + until.size());
            in_.erase(0, text.size());
            return text;
        }
        if (!receive(end)) return {};
    }
}

std::string Wire::read_bytes(std::size_t count, std::chrono::milliseconds limit) {
    const auto end = after(limit);
    while (in_.size() < count)
        if (!receive(end)) return {};
    auto text = in_.substr(0, count);
    in_.erase(0, count);
    return text;
}

bool Wire::closed(std::chrono::milliseconds limit) {
    const auto end = after(limit);
    while (receive(end))
        in_.clear();
    return ended_;
}

HttpAnswer read_answer(Wire& wire, std::chrono::milliseconds limit) {
    auto answer = read_head(wire, limit);
    if (answer.headers.count("content-length") > 0)
        answer.body = wire.read_bytes(std::stoul(answer.headers["content-length"]), limit);
    return answer;
}

HttpAnswer request(std::uint16_t port, const std::string& method, const std::string& target,
                   const std::string& body, const Headers& headers) {
    Wire wire(port);
    wire.send(request_text(method, target, body, headers));
    return read_answer(wire);
}

EventStream::EventStream(std::uint16_t port, const std::string& target, const Headers& headers)
    : wire_(port) {
    wire_.send(request_text("GET", target, {}, headers));
    head_ = read_head(wire_, kDeadline);
}

EventStream::Event EventStream::next(std::chrono::milliseconds limit) {
    const auto end = after(limit);
    for (;;) {
        const auto at = text_.find("\n\n");
        if (at != std::string::npos) {
            const auto block = text_.substr(0, at + 1);
            text_.erase(0, at + 2);
            Event event;
            for (std::size_t line = 0; line < block.size();) {
                const auto stop = block.find('\n', line);
                const auto text = block.substr(line, stop - line);
                if (text.starts_with("id: ")) event.id = text.substr(4);
                if (text.starts_with("event: ")) event.kind = text.substr(7);
                if (text.starts_with("data: ")) event.data = text.substr(6);
                line = stop + 1;
            }
            if (!event.kind.empty()) return event;
            continue;
        }
        const auto left =
            std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
        if (left.count() <= 0) return {};
        const auto size = wire_.read_until("\r\n", left);
        if (size.empty()) return {};
        const auto chunk = wire_.read_bytes(std::stoul(size, nullptr, 16) + 2);
        if (chunk.size() < 3) return {};
        text_.append(chunk, 0, chunk.size() - 2);
    }
}

EventStream::Event EventStream::next(const std::string& kind, std::chrono::milliseconds limit) {
    const auto end = after(limit);
    while (std::chrono::steady_clock::now() < end) {
        auto event = next(limit);
        if (event.kind == kind || event.kind.empty()) return event;
    }
    return {};
}

Socket::Socket(std::uint16_t port, const Headers& headers, const std::string& target) : wire_(port) {
    auto all = headers;
    all.insert(all.end(), {{"Upgrade", "websocket"},
                           {"Connection", "Upgrade"},
                           {"Sec-WebSocket-Version", "13"},
                           {"Sec-WebSocket-Key", "dGhlIHNhbXBsZSBub25jZQ=="}});
    wire_.send(request_text("GET", target, {}, all));
    status_ = read_head(wire_, kDeadline).status;
}

bool Socket::frame(unsigned char first, const std::string& payload, bool masked) {
    std::string bytes(1, static_cast<char>(first));
    const auto mask = static_cast<char>(masked ? 0x80 : 0);
    if (payload.size() < 126) {
        bytes += static_cast<char>(mask | static_cast<char>(payload.size()));
    } else {
        bytes += static_cast<char>(mask | 126);
        bytes += static_cast<char>(payload.size() >> 8 & 0xff);
        bytes += static_cast<char>(payload.size() & 0xff);
    }
    if (masked) bytes += std::string("\1\2\3\4");
    for (std::size_t i = 0; i < payload.size(); ++i)
        bytes += static_cast<char>(masked ? payload[i] ^ "\1\2\3\4"[i % 4] : payload[i]);
    return wire_.send(bytes);
}

std::string Socket::message(std::chrono::milliseconds limit) {
    for (;;) {
        const auto head = wire_.read_bytes(2, limit);
        if (head.size() < 2) return {};
        std::size_t size = static_cast<unsigned char>(head[1]) & 0x7f;
        if (size >= 126) {
            const auto more = wire_.read_bytes(size == 126 ? 2 : 8);
            size = 0;
            for (const char c : more)
                size = size << 8 | static_cast<unsigned char>(c);
        }
        const auto payload = wire_.read_bytes(size);
        const int operation = head[0] & 0xf;
        if (operation == 8) {
            if (payload.size() >= 2)
                code_ = static_cast<unsigned char>(payload[0]) << 8 | static_cast<unsigned char>(payload[1]);
            return {};
        }
        if (operation == 1) return payload;
    }
}

int Socket::close_code(std::chrono::milliseconds limit) {
    const auto end = after(limit);
    while (code_ == 0 && std::chrono::steady_clock::now() < end)
        if (message(limit).empty()) break;
    return code_ != 0 ? code_ : wire_.closed(std::chrono::milliseconds(1000)) ? 0 : -1;
}

}  // namespace asip::test
