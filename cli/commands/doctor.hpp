// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cli/environment.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct DoctorOptions {
    bool registries = false;  ///< list them instead
    bool agents = false;      ///< list what they counted instead
    OutputOptions output{};
};

/// `asipctl doctor`: looks at broker, registry, boards and this machine. kExitFailure when something is
/// wrong, kExitBroker when the broker is.
int run_doctor(const DoctorOptions& options, Environment& environment);

}  // namespace asip::cli
