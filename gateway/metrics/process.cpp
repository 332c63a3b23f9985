// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <filesystem>

#include "asip/program/process_usage.hpp"
#include "gateway/metrics/all_metrics.hpp"

namespace asip::gateway::metrics {
namespace {

const double kStarted =
    std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();

}  // namespace

void read_process(Snapshot& snapshot) {
    snapshot.started_at = kStarted;
    const auto usage = program::process_usage();
    snapshot.processor_seconds = usage.processor_seconds;
    snapshot.resident_bytes = usage.resident_bytes;
    std::error_code error;
    for (auto each = std::filesystem::directory_iterator("/proc/self/fd", error);
         !error && each != std::filesystem::directory_iterator(); each.increment(error))
        ++snapshot.open_files;
}

}  // namespace asip::gateway::metrics
