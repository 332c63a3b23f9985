// SPDX-License-Identifier: Apache-2.0
#include "asip/catalogue/due_slots.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

namespace asip::catalogue {
namespace {

using namespace std::chrono_literals;

TEST(DueSlots, RandomUse_AgreesWithAMap) {
    for (unsigned seed = 0; seed < 40; ++seed) {
        std::mt19937 random(seed);
        DueSlots slots;
        std::map<std::uint32_t, Time> model;
        Time now = Time{} + 1h;
        for (int step = 0; step < 4000; ++step) {
            const std::uint32_t slot = random() % 50;
            const auto pick = random() % 10;
            if (pick < 6) {
                const unsigned span = pick < 2 ? 1'000'000'000u : 3'000'000u;
                model[slot] = now + std::chrono::microseconds(random() % span) - 1s;
                slots.set(slot, model[slot]);
            } else if (pick < 7) {
                slots.remove(slot);
                model.erase(slot);
            } else {
                const bool long_pause = pick == 7 && random() % 50 == 0;
                now += std::chrono::microseconds(random() % (long_pause ? 2'000'000'000u : 400'000u));
                std::vector<std::uint32_t> out, expected;
                slots.advance(now, out);
                std::set<std::pair<Time, std::uint32_t>> due;
                for (const auto& [each, time] : model)
                    if (time <= now) due.emplace(time, each);
                for (const auto& [time, each] : due)
                    expected.push_back(each), model.erase(each);
                ASSERT_EQ(out, expected) << "seed " << seed << " step " << step;
            }
            ASSERT_EQ(slots.size(), model.size());
            std::optional<Time> next;
            for (const auto& [each, time] : model) {
                ASSERT_EQ(slots.due(each), time);
                next = std::min(next.value_or(time), time);
            }
            ASSERT_EQ(slots.next(), next) << "seed " << seed << " step " << step;
        }
    }
}

}  // namespace
}  // namespace asip::catalogue
