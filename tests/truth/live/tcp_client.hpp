// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <unordered_map>

#include "asip/session/board_session.hpp"

namespace truth {

/// A client of an agent's TCP port with a board session of its own, as the library's client has it.
class TcpClient {
  public:
    using Ended = std::function<void(const asip::session::Finished&)>;
    explicit TcpClient(std::uint16_t port) : port_(port) {}
    ~TcpClient();
    TcpClient(const TcpClient&) = delete;
    TcpClient& operator=(const TcpClient&) = delete;

    /// False: refused, not sent. `ended` is called once, from pump().
    bool submit(const std::string& line, asip::Duration deadline, Ended ended);
    void pump();

  private:
    void open();
    void lose();
    void perform(asip::session::Actions& actions);

    std::uint16_t port_;
    int socket_ = -1;
    asip::Time retry_{};
    std::string to_send_;
    asip::session::BoardSession session_;
    std::unordered_map<asip::session::RequestId, Ended> open_;
};

}  // namespace truth
