// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/support/wait.hpp"

namespace asip::test {

/// A TCP connection to 127.0.0.1 that sends any bytes, right or wrong. Everything waits at most kDeadline.
class Wire {
  public:
    explicit Wire(std::uint16_t port);
    ~Wire();
    Wire(Wire&& other) noexcept : socket_(std::exchange(other.socket_, -1)), in_(std::move(other.in_)) {}
    Wire& operator=(Wire&&) = delete;

    /// False: the other side closed.
    bool send(std::string_view bytes);
    /// What was received until the text contains `until`; what is behind it stays. Empty: it did not come.
    std::string read_until(std::string_view until, std::chrono::milliseconds limit = kDeadline);
    std::string read_bytes(std::size_t count, std::chrono::milliseconds limit = kDeadline);
    /// The other side closed, within `limit`.
    bool closed(std::chrono::milliseconds limit = kDeadline);
    int socket() const { return socket_; }
    /// Not yet read by read_until() or read_bytes().
    const std::string& waiting() const { return in_; }

  private:
    bool receive(std::chrono::steady_clock::time_point until);
    int socket_ = -1;
    std::string in_;
    bool ended_ = false;  // by the other side
};

struct HttpAnswer {
    int status = 0;
    std::map<std::string, std::string> headers;  ///< names in lower case
    std::string body;
    nlohmann::json json() const { return nlohmann::json::parse(body, nullptr, false); }
    std::string detail() const { return json().value("detail", ""); }
};

/// Reads one answer off the wire.
HttpAnswer read_answer(Wire& wire, std::chrono::milliseconds limit = kDeadline);

using Headers = std::vector<std::pair<std::string, std::string>>;

/// One request over a connection of its own.
HttpAnswer request(std::uint16_t port, const std::string& method, const std::string& target,
                   const std::string& body = {}, const Headers& headers = {});
inline HttpAnswer get(std::uint16_t port, const std::string& target, const Headers& headers = {}) {
    return request(port, "GET", target, {}, headers);
}
inline HttpAnswer post(std::uint16_t port, const std::string& target, const std::string& body = "{}",
                       const Headers& headers = {}) {
    return request(port, "POST", target, body, headers);
}

/// A stream of Server-Sent Events.
class EventStream {
  public:
    EventStream(std::uint16_t port, const std::string& target, const Headers& headers = {});

    struct Event {
        std::string id, kind, data;
    };
    /// The next event that is no comment; an empty kind: none came.
    Event next(std::chrono::milliseconds limit = kDeadline);
    /// Passes over events until one of this kind.
    Event next(const std::string& kind, std::chrono::milliseconds limit = kDeadline);
    const HttpAnswer& head() const { return head_; }
    Wire& wire() { return wire_; }

  private:
    Wire wire_;
    HttpAnswer head_;
    std::string text_;
};

/// A WebSocket, with frames as a test wants them.
class Socket {
  public:
    explicit Socket(std::uint16_t port, const Headers& headers = {},
                    const std::string& target = "/api/stream");

    int status() const { return status_; }
    void send(const std::string& text) { frame(0x81, text); }
    /// `first` is the first byte: FIN and operation code. False: the other side closed.
    bool frame(unsigned char first, const std::string& payload, bool masked = true);
    /// The next message's text; empty: none came, or the connection was closed.
    std::string message(std::chrono::milliseconds limit = kDeadline);
    nlohmann::json json(std::chrono::milliseconds limit = kDeadline) {
        return nlohmann::json::parse(message(limit), nullptr, false);
    }
    /// The code of the close frame; 0: the connection ended without one, -1: it did not end.
    int close_code(std::chrono::milliseconds limit = kDeadline);
    Wire& wire() { return wire_; }

  private:
    Wire wire_;
    int status_ = 0;
    int code_ = 0;
};

}  // namespace asip::test
