// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>

namespace asip::program {

/// Runs `service` and returns its exit status. A supervised program runs it again after kExitBroker or
/// kExitNameConflict, 30 s to 5 min later, until it was stopped.
int keep_running(const std::function<int()>& service);

}  // namespace asip::program
