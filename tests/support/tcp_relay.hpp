// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>

namespace asip::test {

/// Passes TCP connections on to a port of 127.0.0.1, until the way is cut. Has a thread of its own.
class TcpRelay {
  public:
    /// Meets some connections with silence for ever.
    using Swallows = std::function<bool(std::string_view first_bytes_of_client)>;
    explicit TcpRelay(std::uint16_t to, Swallows swallows = {});
    ~TcpRelay();
    TcpRelay(const TcpRelay&) = delete;
    TcpRelay& operator=(const TcpRelay&) = delete;

    std::uint16_t port() const;
    /// Nothing passes, either way, and no connection is closed.
    void cut();
    /// The same of the connections that `which` names by their first bytes.
    void cut(Swallows which);
    /// What waited passes.
    void restore();

  private:
    class State;
    std::unique_ptr<State> state_;
};

}  // namespace asip::test
