// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gateway/commands/commands.hpp"
#include "gateway/http/server.hpp"
#include "gateway/metrics/command_times.hpp"
#include "gateway/metrics/exposition.hpp"

namespace asip::gateway::metrics {

/// All that is shown, as it is at one moment. The caller fills it; of an asker with limited rights only with
/// what the asker may see.
struct Snapshot {
    http::ServerCounters server;
    Commands::Counters commands;
    CommandTimes durations;
    bool broker_connected = false;
    std::size_t streams = 0;
    // Of Values: since the start, and what is kept now.
    std::uint64_t values_received = 0;
    std::uint64_t values_left_out = 0;
    std::size_t values_bytes = 0;
    std::size_t last_values_bytes = 0;
    std::vector<std::pair<std::string, std::size_t>> boards_by_state;
    std::vector<std::pair<std::string, std::size_t>> lost_by_reason;  ///< each reason, also where none is
    std::vector<std::pair<std::string, std::size_t>> services_by_kind;
    std::vector<std::pair<std::string, std::string>> registries;  ///< id, JSON of its `$stats`
    std::vector<std::pair<std::string, std::string>> boards;      ///< name, JSON of its `$stats`
    // Of the operating system: read_process().
    double resident_bytes = 0;
    double processor_seconds = 0;
    double open_files = 0;
    double started_at = 0;  ///< seconds since 1970
};

/// Beyond these many different values of a label the rest is left out, or counted together.
inline constexpr std::size_t kMaxBoards = 2000;
inline constexpr std::size_t kMaxKinds = 100;
inline constexpr std::size_t kMaxOutcomes = 20;

/// The snapshot as text in one of the two formats. Statistics that are no JSON object, or hold no number
/// where one is expected, are passed over: agents and registries of other versions write them. Pure.
std::string exposition(const Snapshot& snapshot, Exposition::Format format);

/// What the operating system counts of this process.
void read_process(Snapshot& snapshot);

}  // namespace asip::gateway::metrics
