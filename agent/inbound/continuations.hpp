// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace asip::agent {

/// Begins to count SIGCONT. Call it once.
void count_continuations();
/// The count is right as soon as the process runs again, before it reads anything.
unsigned continuations();

}  // namespace asip::agent
