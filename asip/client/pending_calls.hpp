// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "asip/client/awaitable.hpp"

#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "asip/time.hpp"

namespace asip::client {

/// Calls under way, each waiting for its one outcome: begin(), then send, then wait() until the
/// transport calls finish().
class PendingCalls {
  public:
    using Id = std::uint64_t;
    using Outcome = Result<nlohmann::json>;

    explicit PendingCalls(boost::asio::any_io_executor executor) : executor_(std::move(executor)) {}

    void begin(Id id);
    /// Returns what finish() gave, or kTimeout with `late` after `limit`. The id is free afterwards.
    Awaitable<nlohmann::json> wait(Id id, Duration limit, std::string late);
    /// Does nothing for an id that is not waited for.
    void finish(Id id, Outcome outcome);
    void finish_all(const Error& error);

  private:
    struct Call {
        explicit Call(const boost::asio::any_io_executor& executor) : timer(executor) {}
        boost::asio::steady_timer timer;
        std::optional<Outcome> outcome;
    };
    static Awaitable<nlohmann::json> wait_for(std::shared_ptr<Call> call, Duration limit, std::string late);

    boost::asio::any_io_executor executor_;
    std::map<Id, std::shared_ptr<Call>> calls_;
};

}  // namespace asip::client
