// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "asip/bus/topics.hpp"
#include "asip/mqtt/message.hpp"

namespace asip::registry {

/// Finds another living registry with the same id: by asking when connecting, and by the statistics that both
/// publish on one topic. Pure.
class IdentityWatch {
  public:
    /// `run`: random, what the epochs of this run begin with: everybody reads it, so that neither the reply
    /// topic nor `question`, by which probe() is known, may be found by it.
    IdentityWatch(const bus::Topics& topics, std::string id, std::string run, std::string reply_topic,
                  const std::string& question);

    /// Subscribe to it, and to the statistics of this id, before probe() is published.
    std::string reply_topic() const { return reply_topic_; }
    /// A query to the registry of this id.
    mqtt::Message probe() const;
    /// Whether this is probe(), received by its sender: not to be answered.
    bool is_probe(const mqtt::Message& message) const { return message.payload == probe_; }

    /// The epoch of another registry with this id, where the message (on one of the two topics) is of one.
    std::optional<std::string> other(const mqtt::Message& message) const;

  private:
    const bus::Topics& topics_;
    std::string id_;
    std::string run_;
    std::string reply_topic_;
    std::string probe_;
};

}  // namespace asip::registry
