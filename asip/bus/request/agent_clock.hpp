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

/// The name of a reading, as MQTT 5 user property and as member of requests and answers.
inline constexpr std::string_view kClockName = "clock";

/// The clock by which an agent counts deadlines, for programs that ask: a command that says when it was sent,
/// by the clock of the agent that gets it, is never executed late, however long brokers held it and whatever
/// the clocks of the machines say. A reading is text, `1f3c09aa-123456`: which start of which agent (random),
/// and milliseconds.
class AgentClock {
  public:
    explicit AgentClock(const Random& random) : agent_(random_hex(random, 8)) {}

    std::string read(Time now) const;
    /// When `reading` was read, at the latest; nothing: it is no reading, or one of another start.
    std::optional<Time> time_of(std::string_view reading) const;

  private:
    std::string agent_;
};

/// What a program knows of the clocks of the agents that it commands, from their answers. An answer was read
/// off the clock between the question and its arrival here, so each makes a clock better known: of all of
/// them the shortest way counts. Pure.
class AgentClocks {
  public:
    /// More are not remembered: then all are learned anew.
    static constexpr std::size_t kMax = 16'384;

    /// `of`: any name of the one agent. What is no reading is ignored.
    void note(const std::string& of, std::string_view reading, Time asked, Time answered);
    /// What the clock shows at `now`: up to the shortest way of a question and its answer more, never less.
    /// Empty: not known.
    std::string reading(const std::string& of, Time now) const;

  private:
    struct Known {
        std::string agent;
        Duration ahead;  // of our clock
    };
    std::map<std::string, Known, std::less<>> known_;
};

}  // namespace asip::bus
