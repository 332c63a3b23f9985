// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <map>

#include "asip/bus/request/requester.hpp"
#include "asip/bus/topics.hpp"
#include "asip/mqtt/client.hpp"
#include "tests/cluster/history.hpp"

namespace cluster {

Millis now();

/// A client that commands one board after the other, whatever the state of its connection, as programs do.
class Commander {
  public:
    /// What it sends.
    struct Load {
        std::size_t boards = 1;  ///< boards 0 to `boards` - 1 of the history, one after the other
        std::size_t first = 0;   ///< the board to begin with
        double per_second = 1;
        std::function<std::string(std::size_t board, std::size_t token)> request{};
        int qos = 0;  ///< 0 as the client library, 1 as other programs
    };
    Commander(boost::asio::io_context& io, asip::mqtt::Options options, History& history, const Load& load);

    void start();
    /// Sends no more; answers are still taken.
    void stop() { timer_.cancel(); }
    /// Whether every command was answered, or can no longer be.
    bool idle() const { return waiting_.empty(); }

  private:
    struct Waiting {
        asip::bus::Requester::Request request;
        Millis until;
    };
    void send();
    void answered(std::size_t token, const asip::mqtt::Message& message);

    History& history_;
    asip::bus::Topics topics_;
    asip::bus::Requester requester_;
    asip::mqtt::Client client_;
    boost::asio::steady_timer timer_;
    std::chrono::microseconds pause_;
    Load load_;
    std::size_t next_;
    std::map<std::size_t, Waiting> waiting_;
};

}  // namespace cluster
