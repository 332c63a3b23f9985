#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "asip/text/wall_time.hpp"
#include "registry/catalogue/catalogue.hpp"

namespace asip::registry {

/// What the program counts beside the catalogue.
struct StatsInput {
    std::string version;
    std::string epoch;
    std::uint64_t seq = 0;
    text::WallTime at{};
    double uptime_seconds = 0;
    std::uint64_t connections = 0;
    std::uint64_t messages = 0;
    double messages_per_second = 0;  // since the last statistics
    std::uint64_t queries = 0;
    std::uint64_t events = 0;
};

/// The payload of a registry's `$stats`: JSON, documented in docs/asip-registry.md.
std::string stats_text(const CatalogueStats& stats,
                       const std::vector<std::pair<std::string, std::size_t>>& by_kind,
                       const StatsInput& input);

}  // namespace asip::registry
