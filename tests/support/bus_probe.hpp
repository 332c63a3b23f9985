// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "asip/mqtt/message.hpp"
#include "tests/support/wait.hpp"

namespace asip::test {

/// A plain MQTT client that shares no code with ours: records what it sees, publishes what it is given. Has a
/// thread of its own, so that a test can just wait.
class BusProbe {
  public:
    struct Options {
        bool v5 = true;
        std::string user{}, password{};
        std::string client_id{};  ///< empty: made up
        std::string ca{}, cert{}, key{};
        std::optional<mqtt::Message> will{};
    };

    /// Connects to 127.0.0.1 and subscribes to `filters` (QoS 1) before it returns. Throws std::runtime_error
    /// when the broker does not take it within the deadline.
    explicit BusProbe(std::uint16_t port, std::vector<std::string> filters = {"#"})
        : BusProbe(port, filters, Options{}) {}
    BusProbe(std::uint16_t port, std::vector<std::string> filters, Options options);
    ~BusProbe();

    void subscribe(const std::string& filter, int qos = 1);

    void publish(const mqtt::Message& message);
    void publish(const std::string& topic, const std::string& payload, bool retain = false, int qos = 1);
    /// Whether the broker has acknowledged everything published with QoS 1.
    bool all_acknowledged();

    /// What was received so far, in order.
    std::vector<mqtt::Message> messages() const;
    std::vector<mqtt::Message> messages(const std::string& topic) const;
    /// Payload of the newest message on this topic.
    std::optional<std::string> last(const std::string& topic) const;
    std::size_t count(const std::string& topic) const;
    void clear();

    using Match = std::function<bool(const mqtt::Message&)>;
    /// The first message, already received or to come, that matches.
    std::optional<mqtt::Message> wait_for(const Match& match,
                                          std::chrono::milliseconds limit = kDeadline) const;
    std::optional<mqtt::Message> wait_for(const std::string& topic,
                                          std::chrono::milliseconds limit = kDeadline) const;
    std::optional<mqtt::Message> wait_for(const std::string& topic, const std::string& payload,
                                          std::chrono::milliseconds limit = kDeadline) const;

    /// Publishes a request with response topic and correlation data (MQTT 5) or `reply_to` and `id` (a JSON
    /// payload on 3.1.1) and returns the answer's payload.
    std::optional<std::string> request(const std::string& topic, const std::string& payload,
                                       std::chrono::milliseconds limit = kDeadline);

    bool connected() const;
    /// How often the connection was lost and made again. The subscriptions are there again; what was
    /// published meanwhile is lost.
    int reconnects() const;
    /// Cuts the TCP connection without DISCONNECT: the will is published.
    void drop();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace asip::test
