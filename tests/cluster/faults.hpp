// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "tests/cluster/history.hpp"

namespace cluster {

/// What a fault is done to.
enum class Target {
    kNode,     ///< one broker of the engine
    kCluster,  ///< all brokers of the engine at once
    kRegistry,
    kAgent,
    kLink,    ///< the connection between a board and its agent
    kAgents,  ///< all agents of one host
    kClock,   ///< the time of day of one registry and the agents of one host
};
enum class Action {
    kKill,  ///< kill -9, started again after `lasts`; a link is cut and comes back
    kStop,  ///< SIGSTOP, SIGCONT after `lasts`; not of a link
    // The network between the target and all others:
    kCut,     ///< no packet goes either way
    kCutIn,   ///< none comes to the target
    kCutOut,  ///< none comes from it
    kFlap,    ///< a second cut, a second whole, and so on
    kSlow,    ///< 200 ms later, 5 % lost
    kStep,    ///< only of a clock: a day ahead, and back after `lasts`
};

struct Fault {
    Target target = Target::kNode;
    Action action = Action::kKill;
    std::size_t index = 0;  ///< which of its kind; a cluster has one
    Millis after = 0;       ///< from the begin of the round
    Millis lasts = 0;

    bool operator==(const Fault&) const = default;
};

bool is_of_network(Action action);

/// "agent kill"
std::string name_of(const Fault& fault);
/// The names of a round's faults in alphabetical order, "agent stop + broker kill".
std::string name_of(const std::vector<Fault>& faults);

/// How many there are of each kind.
struct Shape {
    std::size_t nodes = 1, registries = 3, boards = 12;
    std::size_t shares = 0;  ///< hosts of agents; none: no faults of the network
    bool clock = false;
    bool processes = true;  ///< also faults of processes and links
    Millis longest_stop = 20'000;
    std::string only{};  ///< this fault, by name_of(), alone; empty: all that are possible
};

/// Each kind of fault once, alone; stops of 5 s.
std::vector<std::vector<Fault>> each_once(std::uint64_t seed, const Shape& shape);
/// Whether the shape has it.
bool is_known(const std::string& fault, const Shape& shape);
/// Faults alone and in pairs, at random: the same seed and shape give the same.
std::vector<std::vector<Fault>> at_random(std::uint64_t seed, std::size_t rounds, const Shape& shape);

}  // namespace cluster
