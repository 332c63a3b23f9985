// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>

#include "gateway/http/server.hpp"
#include "gateway/http/transport.hpp"

namespace asip::gateway::http {

class WebSocket {
  public:
    virtual ~WebSocket() = default;
    /// Without a close frame.
    virtual void close() = 0;
    /// The server ends: a close frame follows what is being sent.
    virtual void leave() = 0;

    /// Adds a job of its client.
    using InTurn = std::function<void(bus::Shares::Job)>;
    /// Answers the upgrade and serves `channel` until the end, then calls `ended` once. `request`:
    /// is_upgrade().
    static std::shared_ptr<WebSocket> start(Transport transport, const Request& request,
                                            std::unique_ptr<Channel> channel, const ServerLimits& limits,
                                            InTurn in_turn, std::function<void()> ended);
};

}  // namespace asip::gateway::http
