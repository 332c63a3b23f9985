// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "tests/truth/exhaustive/trial.hpp"

namespace truth {

/// Every single fault of a scenario that ran undisturbed as `calm` says: each byte of both directions lost,
/// doubled, changed in each bit, delayed past each time-out, and the line cut there; and at each moment a
/// reset, a stall and an unplugging.
std::vector<Faults> single_faults(const TrialEnd& calm);

}  // namespace truth
