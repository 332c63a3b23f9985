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

/// Reads and checks all parts: pins exist, are free and can do it, names are unique, timers suffice. The
/// error begins with the place: "/parts/1/pin: is missing".
Expected<std::vector<PlannedPart>> plan_parts(const BoardConfig& config, const BoardKind& board);

}  // namespace asip::sim
