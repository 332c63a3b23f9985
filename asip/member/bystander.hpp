// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/topics.hpp"
#include "asip/member/announcer.hpp"

namespace asip::member {

/// What a member of the bus that executes nothing does with commands: it refuses each, so that its sender
/// knows. Pure.
class Bystander {
  public:
    /// `reason` is the word of the refusal for programs, `text` the sentence for people.
    Bystander(const bus::Topics& topics, std::string board, std::string reason, std::string text);

    /// What commands to the board come by, beside what its Announcer needs.
    std::vector<Announcer::Subscription> subscriptions() const;

    /// Whether it is a command to a board, which an announcer has nothing to do with.
    bool is_command(const mqtt::Message& message) const;
    /// The answer to a command that wants one. A retained command gets none.
    void refuse(const mqtt::Message& command, Announcements& out) const;

  private:
    bus::Topics topics_;
    std::string board_;
    std::string reason_;
    std::string text_;
};

}  // namespace asip::member
