// SPDX-License-Identifier: Apache-2.0
#include "figures.hpp"

#include <gtest/gtest.h>

namespace asip::firmware {
namespace {

TEST(FiguresTest, EveryFigure_IsMet) {
    for (const auto& figure : measure_figures()) {
        RecordProperty(figure.name, std::to_string(figure.measured));
        EXPECT_TRUE(figure.met(figure.must))
            << figure.name << " is " << figure.measured << ", must be " << figure.must;
        // The aims are reached, and are not to be lost unnoticed.
        EXPECT_TRUE(figure.met(figure.aim))
            << figure.name << " is " << figure.measured << ", aim " << figure.aim;
    }
}

}  // namespace
}  // namespace asip::firmware
