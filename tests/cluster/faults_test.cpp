// SPDX-License-Identifier: Apache-2.0
#include "tests/cluster/faults.hpp"

#include <gmock/gmock.h>

#include <set>

namespace cluster {
namespace {

const Shape kThreeNodes{.nodes = 3, .registries = 3, .boards = 12};

TEST(Faults, SameSeed_SamePlanAndOthersDiffer) {
    EXPECT_EQ(at_random(7, 50, kThreeNodes), at_random(7, 50, kThreeNodes));
    EXPECT_NE(at_random(7, 50, kThreeNodes), at_random(8, 50, kThreeNodes));
    EXPECT_EQ(each_once(7, kThreeNodes), each_once(7, kThreeNodes));
}

TEST(Faults, EachOnce_HasEveryKindAndTheClusterOnlyWhereThereIsOne) {
    std::set<std::string> names;
    for (const auto& faults : each_once(1, kThreeNodes))
        names.insert(name_of(faults));
    EXPECT_THAT(names, testing::ElementsAre("agent kill", "agent stop", "broker kill", "broker stop",
                                            "cluster kill", "link kill", "registry kill", "registry stop"));
    EXPECT_EQ(each_once(1, Shape{}).size(), 7u);
}

TEST(Faults, WithHosts_EachTargetHasEachWeatherAndWithoutThemNone) {
    Shape shape = kThreeNodes;
    shape.shares = 3;
    shape.clock = true;
    std::set<std::string> names;
    for (const auto& faults : each_once(1, shape))
        names.insert(name_of(faults));
    EXPECT_EQ(names.size(), 24u);
    for (const auto* const target : {"broker", "registry", "agents"})
        for (const auto* const weather : {" cut", " cut in", " cut out", " flap", " slow"})
            EXPECT_TRUE(names.contains(std::string(target) + weather)) << target << weather;
    EXPECT_TRUE(names.contains("clock step"));

    shape.processes = shape.clock = false;
    for (const auto& faults : at_random(5, 500, shape))
        for (const auto& fault : faults) {
            EXPECT_TRUE(is_of_network(fault.action)) << name_of(fault);
            EXPECT_LT(fault.index, 3u);
            EXPECT_GE(fault.lasts, 5000);
        }
}

TEST(Faults, ManyRounds_NeverTwoFaultsOfOneProcessAndNoneOutOfBounds) {
    std::size_t pairs = 0;
    for (const auto& faults : at_random(3, 2000, kThreeNodes)) {
        ASSERT_GE(faults.size(), 1u);
        for (const auto& fault : faults) {
            EXPECT_LT(fault.index,
                      fault.target == Target::kAgent || fault.target == Target::kLink ? 12u : 3u);
            EXPECT_LE(fault.lasts, 20'000);
            EXPECT_GE(fault.lasts, fault.action == Action::kStop ? 5000 : 200);
        }
        if (faults.size() == 1) continue;
        ++pairs;
        EXPECT_FALSE(faults[0].target == faults[1].target && faults[0].index == faults[1].index);
        EXPECT_LE(faults[1].after, faults[0].lasts) << "they overlap";
        const bool cluster = faults[0].target == Target::kCluster || faults[1].target == Target::kCluster;
        const bool node = faults[0].target == Target::kNode || faults[1].target == Target::kNode;
        EXPECT_FALSE(cluster && node);
    }
    EXPECT_GT(pairs, 800u);
    EXPECT_LT(pairs, 1200u);
}

TEST(Faults, OnlyOneKind_IsDrawnAloneAndOneThatIsNotThereIsNotKnown) {
    Shape shape = kThreeNodes;
    shape.only = "broker stop";
    for (const auto& faults : at_random(4, 50, shape)) {
        ASSERT_EQ(faults.size(), 1u);
        EXPECT_EQ(name_of(faults), "broker stop");
    }
    EXPECT_TRUE(is_known("broker stop", shape));
    EXPECT_FALSE(is_known("broker cut", shape)) << "there is no network";
    EXPECT_FALSE(is_known("broker", shape));
}

}  // namespace
}  // namespace cluster
