// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "asip/expected.hpp"
#include "asip/mqtt/options.hpp"
#include "asip/time.hpp"

namespace asip::registry {

struct RegistryOptions {
    mqtt::Options mqtt;
    std::string topic_root = "asip";
    std::string id;  ///< of this registry; valid as a service name
    Duration forget_after = std::chrono::hours(7 * 24);
    std::size_t max_boards = 1'000'000;
    Duration stats_interval = std::chrono::seconds(10);
    std::string services;  ///< folder of further service models; empty: none
    std::string history;   ///< SQLite file; empty: none is kept
    Duration history_age = std::chrono::hours(90 * 24);
    std::size_t history_bytes = 256u << 20;
    std::vector<std::string> values;  ///< patterns BOARD/PROPERTY of which values are kept, too
    bool keeps_values = true;         ///< beside the history
    double values_demand = 0;         ///< values a second that are demanded of these; 0: none
    std::size_t values_bytes = std::size_t{1} << 30;
    /// How long changes, minutes and hours are kept.
    std::array<Duration, 3> values_age{std::chrono::hours(48), std::chrono::hours(90 * 24),
                                       std::chrono::hours(1826 * 24)};
    std::string notify;  ///< address that is told of boards that are lost and back; empty: none
};

/// From command line, environment and configuration file. The error is the exit status; all has been printed.
Expected<RegistryOptions, int> read_options(int argc, const char* const* argv);

/// At least a second: "90", "90s", "15m", "12h", "7d".
Expected<Duration> parse_period(const std::string& text);

}  // namespace asip::registry
