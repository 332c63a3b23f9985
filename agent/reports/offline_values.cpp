// SPDX-License-Identifier: Apache-2.0
#include "agent/reports/offline_values.hpp"

#include <utility>

namespace asip::agent {

using program::log::Level;

void OfflineValues::keep(const protocol::ParsedLine& line, Statistics& statistics) {
    if (!line.is_event()) return;
    const auto event = line.event();
    std::string kind{event.service, event.tag};
    // Each port's state is a value of its own.
    if (kind == "Id") kind += event.body.substr(0, event.body.find(','));
    const bool known = newest_.contains(kind);
    const bool full = !known && newest_.size() >= kMaxKinds;
    if (known || full) {
        ++superseded_;
        statistics.value_superseded();
    }
    if (!full) newest_[std::move(kind)] = line;
}

std::vector<protocol::ParsedLine> OfflineValues::take(Effects& out) {
    std::vector<protocol::ParsedLine> lines;
    for (auto& [kind, line] : std::exchange(newest_, {}))
        lines.push_back(std::move(line));
    if (const auto count = std::exchange(superseded_, 0); count > 0)
        out.log(Level::kInfo, "values superseded while the bus was away", {{"count", std::to_string(count)}});
    return lines;
}

}  // namespace asip::agent
