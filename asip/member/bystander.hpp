// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "asip/bus/topics.hpp"
#include "asip/member/announcer.hpp"

namespace asip::member {

/// Refuses each command to a member that executes nothing, so that its sender knows. Pure.
class Bystander {
  public:
    /// `reason` a word for programs, `text` a sentence.
    Bystander(const bus::Topics& topics, std::string board, std::string reason, std::string text);

    /// For commands to the board, beside its Announcer's.
    std::vector<Announcer::Subscription> subscriptions() const;

    /// The announcer has nothing to do with it.
    bool is_command(const mqtt::Message& message) const;
    /// A retained command gets no answer.
    void refuse(const mqtt::Message& command, Announcements& out) const;

  private:
    bus::Topics topics_;
    std::string board_;
    std::string reason_;
    std::string text_;
};

}  // namespace asip::member
