// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "asip/mqtt/message.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// Notes of commands on their way to the bus. They are told together once no command was noted for a moment:
/// histories wait for nothing, while broker and readers would be busy with a note as the answer of the
/// command, or the next command, is on its way. Pure.
class NotesToTell {
  public:
    /// Behind the answer of a command that none follows.
    static constexpr Duration kQuiet = std::chrono::milliseconds(2);
    /// The first of commands that follow each other waits no longer.
    static constexpr Duration kLongest = std::chrono::milliseconds(20);

    void add(std::vector<mqtt::Message> notes, Time now) {
        if (notes.empty()) return;
        if (notes_.empty()) first_ = now;
        due_ = notes_.empty() ? now + kQuiet : first_ + kLongest;
        std::move(notes.begin(), notes.end(), std::back_inserter(notes_));
    }
    std::optional<Time> next_deadline() const { return due_; }
    /// All, in their order, which no longer wait.
    std::vector<mqtt::Message> take() {
        due_.reset();
        return std::exchange(notes_, {});
    }

  private:
    std::vector<mqtt::Message> notes_;
    Time first_{};
    std::optional<Time> due_;
};

}  // namespace asip::agent
