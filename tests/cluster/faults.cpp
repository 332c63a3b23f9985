// SPDX-License-Identifier: Apache-2.0
#include "tests/cluster/faults.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "tests/support/dice.hpp"

namespace cluster {
namespace {

using asip::test::Dice;

constexpr Millis kShortestStop = 5000;

const std::array<std::pair<Target, Action>, 8> kKinds{{
    {Target::kLink, Action::kKill},
    {Target::kAgent, Action::kKill},
    {Target::kAgent, Action::kStop},
    {Target::kRegistry, Action::kKill},
    {Target::kRegistry, Action::kStop},
    {Target::kNode, Action::kKill},
    {Target::kNode, Action::kStop},
    {Target::kCluster, Action::kKill},
}};

std::size_t how_many(Target target, const Shape& shape) {
    switch (target) {
        case Target::kNode:
            return shape.nodes;
        case Target::kCluster:
            return 1;
        case Target::kRegistry:
            return shape.registries;
        case Target::kAgent:
        case Target::kLink:
            break;
    }
    return shape.boards;
}

/// With one node the cluster is that node.
bool possible(Target target, const Shape& shape) {
    return target == Target::kCluster ? shape.nodes > 1 : how_many(target, shape) > 0;
}

Fault draw(Dice& dice, std::pair<Target, Action> kind, const Shape& shape) {
    const auto [target, action] = kind;
    return {.target = target,
            .action = action,
            .index = dice.below(how_many(target, shape)),
            .after = 0,
            .lasts = action == Action::kStop ? dice.between(kShortestStop, shape.longest_stop)
                                             : dice.between(200, 2000)};
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

std::string name_of(const Fault& fault) {
    static const std::array<const char*, 5> names{"broker", "cluster", "registry", "agent", "link"};
    return std::string(names.at(static_cast<std::size_t>(fault.target))) +
           (fault.action == Action::kKill ? " kill" : " stop");
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
        if (possible(kind.first, shape)) plan.push_back({draw(dice, kind, least)});
    return plan;
}

std::vector<std::vector<Fault>> at_random(std::uint64_t seed, std::size_t rounds, const Shape& shape) {
    Dice dice(seed);
    const auto any = [&] {
        auto kind = dice.one_of(kKinds);
        while (!possible(kind.first, shape))
            kind = dice.one_of(kKinds);
        return draw(dice, kind, shape);
    };
    std::vector<std::vector<Fault>> plan(rounds);
    for (auto& round : plan) {
        round.push_back(any());
        if (!dice.chance(0.5)) continue;
        auto second = any();
        while (clash(round.front(), second))
            second = any();
        second.after = dice.between(0, round.front().lasts);
        round.push_back(second);
    }
    return plan;
}

}  // namespace cluster
