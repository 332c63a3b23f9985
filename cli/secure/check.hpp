// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cli/commands/secure.hpp"

namespace asip::cli {

/// Tries what each user (or the named one) may do, and prints a table. kExitFailure: the broker allows
/// something else.
Outcome<int> secure_check(const SecureOptions& options, Environment& environment);

}  // namespace asip::cli
