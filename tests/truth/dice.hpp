// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "tests/support/dice.hpp"
#include "tests/truth/board/firmware.hpp"

namespace truth {

using asip::test::Dice;

constexpr Micros kMillisecond = 1000;
constexpr Micros kSecond = 1'000'000;

}  // namespace truth
