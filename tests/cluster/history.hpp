// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "asip/time.hpp"

namespace cluster {

/// Milliseconds of a monotonic clock.
using Millis = std::int64_t;

/// As asip::Clock has it.
asip::Time time_of(Millis time);

/// How a command ended, as its sender saw it.
enum class Outcome { kOk, kError, kTimeout, kRefused, kUnanswered };
/// "ok", "error", "timeout", "refused", "unanswered"
const char* to_string(Outcome outcome);

/// One command of a client. Its token, which the board finds in it, is its place in History::commands.
struct Command {
    std::size_t board = 0;
    Millis sent = 0;
    std::optional<Millis> answered{};  ///< the first answer
    Outcome outcome = Outcome::kUnanswered;
    std::string reason{};    ///< as bus::Reply::reason
    bool differing = false;  ///< a second answer said something else
};

/// What a board executed, by its own record.
struct Execution {
    std::size_t token = 0;
    std::size_t board = 0;
    Millis at = 0;
};

/// How a registry's catalogue differs from the truth.
struct Difference {
    std::vector<std::string> ghosts{};  ///< listed as online, and not there
    std::vector<std::string> lost{};    ///< there, and not listed as online
    bool none() const { return ghosts.empty() && lost.empty(); }
};

/// A watcher missed events of its registry, by their numbers, while its own connection held.
struct Gap {
    std::string registry;
    std::uint64_t after = 0, next = 0;
    Millis since = 0;  ///< when `after` came
    Millis at = 0;
};

/// One fault, or several at once, and how the system came back.
struct Round {
    std::string name;
    Millis begin = 0;
    Millis end = 0;                            ///< when everything was put back
    std::optional<Millis> commands_work{};     ///< when each board had executed a command sent after `end`
    std::optional<Millis> catalogues_agree{};  ///< since when all registries were right, to the end of the
                                               ///< look
    /// When a client of each node had heard those of all nodes, the nodes had taken something to retain and
    /// new subscriptions, all after `end`: before that no program can do what it is for.
    std::optional<Millis> engine_works{};
    Millis looked_until = 0;
    std::map<std::string, Difference> wrong{};  ///< by registry, where they never agreed
    std::vector<std::size_t> mute{};            ///< boards that executed nothing after `end`
    /// A broker was held by SIGSTOP, or packets of a broker or an agent by the network. When it goes on, what
    /// waits in sockets is delivered, and no program can see how old that is; TCP sends again only after
    /// seconds.
    bool messages_held = false;
    /// A broker node was killed, stopped or cut off, and there are others, or what joins them was killed:
    /// what has QoS 0, as events have, is not kept for it by them.
    bool nodes_apart = false;
    Millis delayed = 0;  ///< the most by which this process itself was too late: a busy machine
};

/// All that the judge knows.
struct History {
    Millis deadline = 5000;  ///< of each command, from its sending
    std::vector<std::string> boards;
    std::vector<Command> commands;
    std::vector<Execution> executions;
    std::vector<Gap> gaps;
    std::vector<Round> rounds;
    std::vector<std::string> exits;  ///< programs that ended by themselves, in words
    Millis ended = 0;
};

}  // namespace cluster
