// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <string>
#include <vector>

#include "asip/expected.hpp"
#include "asip/mqtt/options.hpp"
#include "asip/time.hpp"

namespace asip::mqtt {

/// Finds a broker's addresses without blocking. It lives until `done` was called, or cancel() returned and
/// the io_context ran: let `done` hold the owner.
class HostLookup {
  public:
    /// The first to try stands at the end.
    using Done = std::function<void(Expected<std::vector<std::string>>)>;

    explicit HostLookup(boost::asio::io_context& io) : resolver_(io), timer_(io) {}

    /// Calls `done` once: at once for a numeric address, else from the io_context, after at most `limit`.
    void start(const BrokerAddress& broker, Duration limit, Done done);
    /// `done` is not called any more.
    void cancel();

  private:
    boost::asio::ip::tcp::resolver resolver_;
    boost::asio::steady_timer timer_;
    unsigned number_ = 0;
};

}  // namespace asip::mqtt
