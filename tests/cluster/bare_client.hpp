// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstddef>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "asip/mqtt/options.hpp"
#include "tests/cluster/history.hpp"

struct mosquitto;

namespace cluster {

/// What an engine takes without this project: libmosquitto with nothing around it, in a thread of its own. It
/// goes to the next broker of the list as soon as a connection ends, subscribes to a topic of its own, and
/// writes to it every 20 ms.
class BareClient {
  public:
    /// Of the options only `brokers`, `client_id` and `ca_file` count.
    explicit BareClient(asip::mqtt::Options options);
    ~BareClient();
    BareClient(const BareClient&) = delete;
    BareClient& operator=(const BareClient&) = delete;

    /// From now on only messages count that are sent from now on.
    void look_anew();
    /// When the first of them came.
    std::optional<Millis> heard() const;
    /// The place in the list of the broker that it is connected to, or tries.
    std::size_t node() const { return node_; }

  private:
    void run();
    void serve(mosquitto* client);
    void received(const std::string& payload);

    asip::mqtt::Options options_;
    std::string topic_;
    std::atomic<bool> over_{false};
    std::atomic<std::size_t> node_{0};
    std::atomic<Millis> since_{0};
    std::atomic<Millis> heard_{0};  // 0: not yet
    std::thread thread_;
};

}  // namespace cluster
