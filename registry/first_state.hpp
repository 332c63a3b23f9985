// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <string_view>

#include "asip/bus/topics.hpp"
#include "asip/mqtt/message.hpp"
#include "asip/time.hpp"

namespace asip::registry {

/// Finds when a registry has heard all that the broker retains below the service bus: a mark that it
/// publishes to itself comes back behind that. Pure.
class FirstState {
  public:
    /// Where the mark is lost, the state counts as whole after this time without a retained message.
    static constexpr Duration kRetainedTime = std::chrono::seconds(15);

    /// `mark_topic`: no other program writes there. `complete`: the state is whole.
    FirstState(const bus::Topics& topics, std::string mark_topic, std::function<void(mqtt::Message)> publish,
               std::function<void()> complete)
        : topics_(topics),
          mark_topic_(std::move(mark_topic)),
          publish_(std::move(publish)),
          complete_(std::move(complete)) {}

    /// Call it with the subscriptions made. `mark`: random. Boards are asked to announce themselves, too.
    void begin(std::string mark, Time now) {
        mark_ = std::move(mark);
        until_ = now + kRetainedTime;
        // The mark is sent first: the announcements that answer the probe come behind it. A broker drops
        // messages of QoS 0 for a reader whose queue is full.
        publish(mark_topic_, mark_, 1);
        publish(topics_.probe(), {}, 0);
    }
    void end() { mark_.clear(); }

    bool active() const { return !mark_.empty(); }
    /// True: this message on that topic was the mark.
    bool mark(std::string_view payload) {
        if (!active() || payload != mark_) return false;
        whole();
        return true;
    }
    void retained_came(Time now) { until_ = now + kRetainedTime; }
    void tick(Time now) {
        if (active() && now >= until_) whole();
    }

  private:
    void publish(std::string topic, std::string payload, int qos) {
        publish_(mqtt::Message{.topic = std::move(topic), .payload = std::move(payload), .qos = qos});
    }
    void whole() {
        mark_.clear();
        complete_();
    }

    bus::Topics topics_;
    std::string mark_topic_;
    std::function<void(mqtt::Message)> publish_;
    std::function<void()> complete_;
    std::string mark_;  // the one under way
    Time until_{};
};

}  // namespace asip::registry
