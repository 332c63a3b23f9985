// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "tests/truth/command.hpp"

namespace truth {

/// A command, so long after the board was ready; or the renewal of what its client holds.
struct Step {
    Micros after = 0;
    Command command;
    bool renews = false;
};

/// A short history in which nothing goes wrong. Its faults are tried from `from` on.
struct Scenario {
    std::string name;
    enum class From : std::uint8_t {
        kLinkUp,  ///< the board is found, asked what it is, and moved to a faster line
        kRate,    ///< the board is told to change its rate
        kReady,   ///< the first command
    } from = From::kReady;
    Plan plan;
    std::vector<Step> steps;
};

/// All of them, in an order that stays.
const std::vector<Scenario>& scenarios();

}  // namespace truth
