// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <deque>
#include <functional>
#include <memory>
#include <string>

#include "gateway/cable/cable_way.hpp"
#include "gateway/stream/streams.hpp"

namespace asip::gateway {

/// The WebSocket of a cable: what the board sends goes to its agent, and what the agent sends to the page, as
/// bytes that begin with a link::CableKind. Its end is a pulled cable. Pure.
class CableChannel : public http::Channel, public OpenStream {
  public:
    static constexpr std::size_t kMaxWaiting = std::size_t{256} * 1024;  ///< in each direction
    static constexpr Duration kAlive = std::chrono::seconds(1);  ///< so often the page hears something
    static constexpr double kBytesPerSecond = 1e6 / 8;  ///< of the board, on average; kMaxWaiting at once

    struct Dependencies {
        std::function<Instant()> now;
        std::function<std::unique_ptr<CableWay>(CableWay::Handlers)> open;
        std::string hello;  ///< for the agent
        /// The board is on the bus under this name.
        std::function<void(const std::string& board)> named;
        std::function<void(const std::string& why)> ended;
        Budget::Part part{};  ///< of its client, for all that may wait
    };

    CableChannel(Streams& streams, Dependencies dependencies, Principal principal, std::string client);
    ~CableChannel() override;

    bool binary() const override { return true; }
    bool take(std::string& message) override;
    bool received(std::string_view message) override;
    std::uint16_t close_code() const override;
    void tick(const Instant& now) override;
    void revoke() override;

  private:
    void from_agent(const link::CableMessage& message);
    void put(link::CableKind kind, std::string_view payload);
    /// `code`: of WebSocket.
    void end(const std::string& why, std::uint16_t code);
    bool within_rate(std::size_t bytes);

    Streams& streams_;
    Dependencies dependencies_;
    std::unique_ptr<CableWay> way_;
    std::deque<std::string> out_;
    std::size_t waiting_ = 0;
    double credit_ = kMaxWaiting;
    Time counted_{};
    Time said_{};  // kAlive
    std::string why_ = "the browser that lent it closed";
    std::uint16_t code_ = 0;
};

}  // namespace asip::gateway
