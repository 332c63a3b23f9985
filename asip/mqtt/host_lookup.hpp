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

/// Finds the addresses of a broker without blocking. The owner keeps this alive until `done` was called or
/// cancel() has returned and the io_context has run: let `done` hold the owner.
class HostLookup {
  public:
    /// The addresses, the first to try at the end; or why there are none.
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
