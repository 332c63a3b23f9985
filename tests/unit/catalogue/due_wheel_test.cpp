// SPDX-License-Identifier: Apache-2.0
#include "asip/catalogue/due_wheel.hpp"

#include <gmock/gmock.h>

#include <map>
#include <random>

namespace asip::catalogue {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

Time at(Duration since_start) {
    return Time{} + 1h + since_start;
}

std::vector<std::uint32_t> advanced(DueWheel& wheel, Duration when) {
    std::vector<std::uint32_t> out;
    wheel.advance(at(when), out);
    return out;
}

TEST(DueWheel, DueSlotsComeOutAtTheirTimeEarliestFirst) {
    DueWheel wheel;
    wheel.set(3, at(60s), at(0s));
    wheel.set(1, at(10s), at(0s));
    wheel.set(2, at(10s + 1ns), at(0s));
    EXPECT_THAT(advanced(wheel, 10s - 1ns), IsEmpty());
    EXPECT_THAT(advanced(wheel, 10s), ElementsAre(1));
    EXPECT_THAT(advanced(wheel, 1000s), ElementsAre(2, 3));
    EXPECT_EQ(wheel.size(), 0u);
    EXPECT_EQ(wheel.next(), std::nullopt);
}

TEST(DueWheel, FirstSetFarAhead_DoesNotDelayNearerOnes) {
    DueWheel wheel;
    wheel.set(0, at(60s), at(0s));
    wheel.set(1, at(1s), at(0s));
    EXPECT_THAT(advanced(wheel, 1s), ElementsAre(1));
}

TEST(DueWheel, BeyondTheHorizonAndAfterALongPause_IsExact) {
    DueWheel wheel;
    wheel.set(0, at(7 * 24h), at(0s));
    wheel.set(1, at(400s), at(0s));
    EXPECT_THAT(advanced(wheel, 7 * 24h - 1ns), ElementsAre(1));
    EXPECT_THAT(advanced(wheel, 7 * 24h), ElementsAre(0));
}

TEST(DueWheel, RandomUse_AgreesWithAMap) {
    for (unsigned seed = 0; seed < 40; ++seed) {
        std::mt19937 random(seed);
        DueWheel wheel;
        std::map<std::uint32_t, Time> model;
        Time now = at(0s);
        for (int step = 0; step < 4000; ++step) {
            const std::uint32_t slot = random() % 50;
            const auto pick = random() % 10;
            if (pick < 6) {
                const Time due =
                    now + std::chrono::microseconds(random() % (pick < 2 ? 1'000'000'000u : 3'000'000u)) - 1s;
                wheel.set(slot, due, now);
                model[slot] = due;
            } else if (pick < 7) {
                wheel.remove(slot);
                model.erase(slot);
            } else {
                now += std::chrono::microseconds(
                    random() % (pick == 7 && random() % 50 == 0 ? 2'000'000'000u : 400'000u));
                std::vector<std::uint32_t> out;
                wheel.advance(now, out);
                std::vector<std::pair<Time, std::uint32_t>> expected;
                for (const auto& [each, due] : model)
                    if (due <= now) expected.emplace_back(due, each);
                std::sort(expected.begin(), expected.end());
                ASSERT_EQ(out.size(), expected.size()) << "seed " << seed << " step " << step;
                for (std::size_t i = 0; i < out.size(); ++i) {
                    ASSERT_EQ(out[i], expected[i].second);
                    model.erase(out[i]);
                }
            }
            ASSERT_EQ(wheel.size(), model.size());
            const auto next = wheel.next();
            ASSERT_EQ(next.has_value(), !model.empty());
            for (const auto& [each, due] : model) {
                ASSERT_EQ(wheel.due(each), due);
                ASSERT_LE(*next, std::max(due, now + DueWheel::kTick)) << "seed " << seed << " step " << step;
            }
        }
    }
}

}  // namespace
}  // namespace asip::catalogue
