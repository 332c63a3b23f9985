// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "asip/mqtt/client.hpp"
#include "tests/cluster/history.hpp"

namespace cluster {

/// One of some clients that hear each other and themselves: whether the engine works, apart from registries,
/// agents and boards. Until it has heard all of them, each of its messages has one in front of it that the
/// broker retains: one that cannot do that reads no further, or closes the connection. What it hears itself
/// by is a subscription that is made anew for each look, as programs need one that lost their connection.
class Echo {
  public:
    /// The client `number` of `count`.
    Echo(boost::asio::io_context& io, asip::mqtt::Options options, std::size_t number, std::size_t count);

    void start();
    /// From now on only messages count that are sent from now on.
    void look_anew();
    /// When the first of them had come from each client.
    std::optional<Millis> heard() const;

  private:
    void connect();
    void send();
    void received(const asip::mqtt::Message& message);

    boost::asio::io_context& io_;
    asip::mqtt::Options options_;
    std::string topic_;
    std::string own_;  // of this look
    Millis since_ = 0;
    Millis delivered_ = 0;                      // when anything of its own came, or it connected
    std::vector<std::optional<Millis>> heard_;  // by client
    std::unique_ptr<asip::mqtt::Client> client_;
    boost::asio::steady_timer timer_;
};

}  // namespace cluster
