// SPDX-License-Identifier: Apache-2.0
#include "asip/program/process_usage.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

namespace asip::program {

ProcessUsage process_usage() {
    ProcessUsage result;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    result.processor_seconds = static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                               static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec) / 1e6;
    long pages = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> pages >> resident;
    result.resident_bytes = static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE));
    return result;
}

}  // namespace asip::program
