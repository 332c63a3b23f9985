// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "asip/bus/topics.hpp"
#include "asip/mqtt/message.hpp"

namespace asip::registry {

/// Finds another living registry with the same id, by asking when connecting, and by the statistics of both.
/// Pure.
class IdentityWatch {
  public:
    /// `run`: begins the epochs, which everybody reads; so neither reply topic nor `question`, which marks
    /// probe(), may follow from it.
    IdentityWatch(const bus::Topics& topics, std::string id, std::string run, std::string reply_topic,
                  const std::string& question);

    /// Subscribe to it, and to this id's statistics, before probe() is published.
    std::string reply_topic() const { return reply_topic_; }
    mqtt::Message probe() const;
    /// Our own probe(), which is not answered.
    bool is_probe(const mqtt::Message& message) const { return message.payload == probe_; }

    /// The epoch of another registry with this id, from a message on one of the two topics.
    std::optional<std::string> other(const mqtt::Message& message) const;

  private:
    const bus::Topics& topics_;
    std::string id_;
    std::string run_;
    std::string reply_topic_;
    std::string probe_;
};

}  // namespace asip::registry
