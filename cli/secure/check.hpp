// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cli/commands/secure.hpp"

namespace asip::cli {

/// Tries at the running broker what each user (or the one that is named) may do, and prints a table. The
/// status: kExitFailure when the broker allows something else than it should.
Outcome<int> secure_check(const SecureOptions& options, Environment& environment);

}  // namespace asip::cli
