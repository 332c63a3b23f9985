// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace asip::program {

/// From the operating system.
struct ProcessUsage {
    double processor_seconds = 0;  ///< since its start, in all threads
    double resident_bytes = 0;     ///< memory in use now
};

ProcessUsage process_usage();

}  // namespace asip::program
