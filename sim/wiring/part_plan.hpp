// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "asip/expected.hpp"
#include "sim/board_kind.hpp"
#include "sim/config.hpp"
#include "sim/wiring/part_kind.hpp"

namespace asip::sim {

struct PlannedPart {
    std::string name;  ///< as configured, otherwise made of kind and first pin: "led13"
    PartPlan plan;
};

/// Reads the settings of all parts and checks that they can be wired as asked: every pin exists, is free and
/// can do it, each name is used once, and the simulator has enough timers. The error is one line that begins
/// with the place: "/parts/1/pin: is missing".
Expected<std::vector<PlannedPart>> plan_parts(const BoardConfig& config, const BoardKind& board);

}  // namespace asip::sim
