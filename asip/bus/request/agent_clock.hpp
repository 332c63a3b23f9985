// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "asip/random.hpp"
#include "asip/time.hpp"

namespace asip::bus {

/// As MQTT 5 user property, and as member of requests and answers.
inline constexpr std::string_view kClockName = "clock";

/// The clock by which an agent counts deadlines. A command that says when it was sent, by the clock of its
/// agent, is never executed late, however long brokers held it and whatever the clocks of machines say. A
/// reading is text, `1f3c09aa-123456`: the start of the agent (random), and milliseconds.
class AgentClock {
  public:
    explicit AgentClock(const Random& random) : agent_(random_hex(random, 8)) {}

    std::string read(Time now) const;
    /// At the latest; nothing: no reading, or one of another start.
    std::optional<Time> time_of(std::string_view reading) const;

  private:
    std::string agent_;
};

/// What a program knows of the clocks of agents, from their answers. A clock was read between the question
/// and the arrival of its answer: the shortest way counts. Pure.
class AgentClocks {
  public:
    /// Beyond, all are learned anew.
    static constexpr std::size_t kMax = 16'384;

    /// `of`: any name of the agent. Other texts are ignored.
    void note(const std::string& of, std::string_view reading, Time asked, Time answered);
    /// The clock at `now`, ahead by the shortest way at most, never behind. Empty: not known.
    std::string reading(const std::string& of, Time now) const;

  private:
    struct Known {
        std::string agent;
        Duration ahead;  // of our clock
    };
    std::map<std::string, Known, std::less<>> known_;
};

}  // namespace asip::bus
