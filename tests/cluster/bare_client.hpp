// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstddef>
#include <optional>
#include <string>
#include <thread>

#include "asip/mqtt/options.hpp"
#include "tests/cluster/history.hpp"

struct mosquitto;
struct mosquitto_message;

namespace cluster {

/// What an engine takes without this project: libmosquitto with nothing around it, in a thread of its own. It
/// goes to the next broker of the list as soon as a connection ends, has one subscription, and sends every 20
/// ms a message to itself, and one to another such client, which answers: a command takes that, too.
class BareClient {
  public:
    /// The client `number` of `count`, which asks the one behind it. Of the options only `brokers` and
    /// `ca_file` count.
    BareClient(asip::mqtt::Options options, std::size_t number, std::size_t count);
    ~BareClient();
    BareClient(const BareClient&) = delete;
    BareClient& operator=(const BareClient&) = delete;

    /// From now on only messages count that are sent from now on.
    void look_anew();
    /// When the first of them came that it had sent to itself.
    std::optional<Millis> heard() const { return known(heard_); }
    /// When the first of them was answered by the other client.
    std::optional<Millis> answered() const { return known(answered_); }
    /// The place in the list of the broker that it is connected to, or tries.
    std::size_t node() const { return node_; }

  private:
    void run();
    void serve(mosquitto* client);
    void received(mosquitto* client, const mosquitto_message& message);
    void note(std::atomic<Millis>& first, const std::string& payload) const;
    static std::optional<Millis> known(Millis time);

    asip::mqtt::Options options_;
    const std::string own_, other_;  // what their topics begin with
    std::atomic<bool> over_{false};
    std::atomic<std::size_t> node_{0};
    std::atomic<Millis> since_{0};
    std::atomic<Millis> heard_{0};     // 0: not yet
    std::atomic<Millis> answered_{0};  // 0: not yet
    std::thread thread_;
};

}  // namespace cluster
