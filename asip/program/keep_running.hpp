// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>

namespace asip::program {

/// Runs `service` and returns its exit status. Where the program is supervised, and the broker or another
/// program is in the way (kExitBroker, kExitNameConflict), it runs it again, 30 s to 5 min later, until it
/// was stopped.
int keep_running(const std::function<int()>& service);

}  // namespace asip::program
