// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cli/commands/secure.hpp"

namespace asip::cli {

/// Prints what each user may do, and until when the broker's certificate is valid.
Outcome<void> secure_show(const SecureOptions& options, Environment& environment);

}  // namespace asip::cli
