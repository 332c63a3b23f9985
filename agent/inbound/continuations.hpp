// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace asip::agent {

/// Counts from now on how often this process goes on after a stop (SIGCONT). Call it once.
void count_continuations();
/// How often it did. The count is right as soon as the process runs again, before it reads anything.
unsigned continuations();

}  // namespace asip::agent
