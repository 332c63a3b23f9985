// SPDX-License-Identifier: Apache-2.0
#include "registry/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::registry {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxKinds = 200;

json boards_by_state(const CatalogueStats& stats) {
    json boards = json::object();
    for (std::size_t state = 0; state < kStates; ++state)
        boards[std::string(model::to_text(static_cast<model::BoardState>(state)))] = stats.boards[state];
    return boards;
}

json services_by_kind(const Catalogue& catalogue) {
    json kinds = json::object();
    for (const auto& [kind, count] : catalogue.services_by_kind()) {
        if (kinds.size() == kMaxKinds) break;
        kinds[kind] = count;
    }
    return kinds;
}

json refused_by_reason(const CatalogueStats& stats) {
    json refused = json::object();
    for (std::size_t i = 0; i < kRefusals; ++i) {
        const auto reason = static_cast<Refusal>(i);
        if (reason != Refusal::kNotForUs && stats.refused[i] > 0)
            refused[std::string(to_text(reason))] = stats.refused[i];
    }
    return refused;
}

double seconds(Duration duration) {
    return std::chrono::duration<double>(duration).count();
}

}  // namespace

std::string Statistics::document(const Catalogue& catalogue, const std::string& epoch, std::uint64_t seq,
                                 Instant now) {
    const CatalogueStats stats = catalogue.stats();
    const double since_last = std::max(0.001, seconds(now.time - last_));
    const double rate = static_cast<double>(counts.messages - messages_then_) / since_last;
    last_ = now.time;
    messages_then_ = counts.messages;
    json document{{"version", ASIP_VERSION},
                  {"epoch", epoch},
                  {"seq", seq},
                  {"at", text::iso_time(now.wall)},
                  {"uptime", std::round(seconds(now.time - started_))},
                  {"boards", boards_by_state(stats)},
                  {"services", services_by_kind(catalogue)},
                  {"conflicts", stats.conflicts},
                  {"messages", counts.messages},
                  {"messages_per_second", std::round(rate * 10) / 10},
                  {"renewals", stats.renewals},
                  {"expired", stats.expired},
                  {"refused", refused_by_reason(stats)},
                  {"queries", counts.queries},
                  {"events", counts.events},
                  {"connections", counts.connections}};
    if (counts.denied > 0) document["denied"] = counts.denied;
    if (counts.history_dropped > 0) document["history_dropped"] = counts.history_dropped;
    if (!counts.history_fault.empty()) document["history_fault"] = counts.history_fault.substr(0, 200);
    if (counts.values_kept > 0) document["values_kept"] = counts.values_kept;
    if (counts.values_lost > 0) document["values_lost"] = counts.values_lost;
    if (!counts.values_fault.empty()) document["values_fault"] = counts.values_fault.substr(0, 200);
    return model::dump_json(document);
}

}  // namespace asip::registry
