// SPDX-License-Identifier: Apache-2.0
#include "tests/cluster/faults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "tests/support/dice.hpp"

namespace cluster {
namespace {

using asip::test::Dice;

constexpr Millis kShortestStop = 5000;

const std::array<std::pair<Target, Action>, 24> kKinds{{
    {Target::kLink, Action::kKill},       {Target::kAgent, Action::kKill},
    {Target::kAgent, Action::kStop},      {Target::kRegistry, Action::kKill},
    {Target::kRegistry, Action::kStop},   {Target::kNode, Action::kKill},
    {Target::kNode, Action::kStop},       {Target::kCluster, Action::kKill},
    {Target::kClock, Action::kStep},      {Target::kNode, Action::kCut},
    {Target::kNode, Action::kCutIn},      {Target::kNode, Action::kCutOut},
    {Target::kNode, Action::kFlap},       {Target::kNode, Action::kSlow},
    {Target::kRegistry, Action::kCut},    {Target::kRegistry, Action::kCutIn},
    {Target::kRegistry, Action::kCutOut}, {Target::kRegistry, Action::kFlap},
    {Target::kRegistry, Action::kSlow},   {Target::kAgents, Action::kCut},
    {Target::kAgents, Action::kCutIn},    {Target::kAgents, Action::kCutOut},
    {Target::kAgents, Action::kFlap},     {Target::kAgents, Action::kSlow},
}};

std::size_t how_many(Target target, const Shape& shape) {
    switch (target) {
        case Target::kNode:
            return shape.nodes;
        case Target::kCluster:
        case Target::kClock:
            return 1;
        case Target::kAgents:
            return shape.shares;
        case Target::kRegistry:
            return shape.registries;
        case Target::kAgent:
        case Target::kLink:
            break;
    }
    return shape.boards;
}

/// With one node the cluster is that node.
bool possible(std::pair<Target, Action> kind, const Shape& shape) {
    const auto [target, action] = kind;
    if (!shape.only.empty() && shape.only != name_of(Fault{.target = target, .action = action})) return false;
    if (target == Target::kClock) return shape.clock;
    if (is_of_network(action)) return shape.shares > 0;
    if (!shape.processes) return false;
    return target == Target::kCluster ? shape.nodes > 1 : how_many(target, shape) > 0;
}

Fault draw(Dice& dice, std::pair<Target, Action> kind, const Shape& shape) {
    const auto [target, action] = kind;
    const bool brief = action == Action::kKill;
    return {.target = target,
            .action = action,
            .index = dice.below(how_many(target, shape)),
            .after = 0,
            .lasts = brief ? dice.between(200, 2000) : dice.between(kShortestStop, shape.longest_stop)};
}

/// Two faults of one process: the second would find it dead.
bool clash(const Fault& one, const Fault& other) {
    const auto broker = [](const Fault& fault) {
        return fault.target == Target::kNode || fault.target == Target::kCluster;
    };
    if (broker(one) && broker(other))
        return one.target == Target::kCluster || other.target == Target::kCluster || one.index == other.index;
    return one.target == other.target && one.index == other.index;
}

}  // namespace

bool is_of_network(Action action) {
    return action != Action::kKill && action != Action::kStop && action != Action::kStep;
}

std::string name_of(const Fault& fault) {
    static const std::array<const char*, 7> names{"broker", "cluster", "registry", "agent",
                                                  "link",   "agents",  "clock"};
    static const std::array<const char*, 8> actions{"kill",    "stop", "cut",  "cut in",
                                                    "cut out", "flap", "slow", "step"};
    return fmt::format("{} {}", names.at(static_cast<std::size_t>(fault.target)),
                       actions.at(static_cast<std::size_t>(fault.action)));
}

std::string name_of(const std::vector<Fault>& faults) {
    std::vector<std::string> names;
    for (const auto& fault : faults)
        names.push_back(name_of(fault));
    std::sort(names.begin(), names.end());
    std::string all;
    for (const auto& name : names)
        all += (all.empty() ? "" : " + ") + name;
    return all;
}

std::vector<std::vector<Fault>> each_once(std::uint64_t seed, const Shape& shape) {
    Dice dice(seed);
    auto least = shape;
    least.longest_stop = kShortestStop;
    std::vector<std::vector<Fault>> plan;
    for (const auto& kind : kKinds)
        if (possible(kind, shape)) plan.push_back({draw(dice, kind, least)});
    return plan;
}

bool is_known(const std::string& fault, const Shape& shape) {
    auto alone = shape;
    alone.only = fault;
    return std::any_of(kKinds.begin(), kKinds.end(), [&](const auto& kind) { return possible(kind, alone); });
}

std::vector<std::vector<Fault>> at_random(std::uint64_t seed, std::size_t rounds, const Shape& shape) {
    Dice dice(seed);
    const auto any = [&] {
        auto kind = dice.one_of(kKinds);
        while (!possible(kind, shape))
            kind = dice.one_of(kKinds);
        return draw(dice, kind, shape);
    };
    std::vector<std::vector<Fault>> plan(rounds);
    for (auto& round : plan) {
        round.push_back(any());
        if (!shape.only.empty() || !dice.chance(0.5)) continue;
        auto second = any();
        while (clash(round.front(), second))
            second = any();
        second.after = dice.between(0, round.front().lasts);
        round.push_back(second);
    }
    return plan;
}

}  // namespace cluster
