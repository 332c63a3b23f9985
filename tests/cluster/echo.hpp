// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <optional>
#include <string>

#include "asip/mqtt/client.hpp"
#include "tests/cluster/history.hpp"

namespace cluster {

/// A client that hears itself: whether the engine works, apart from registries, agents and boards.
class Echo {
  public:
    Echo(boost::asio::io_context& io, asip::mqtt::Options options);

    void start();
    /// From now on only messages count that are sent from now on.
    void look_anew();
    /// When the first of them came.
    std::optional<Millis> heard() const { return heard_; }

  private:
    void send();

    std::string topic_;
    Millis since_ = 0;
    std::optional<Millis> heard_;
    asip::mqtt::Client client_;
    boost::asio::steady_timer timer_;
};

}  // namespace cluster
