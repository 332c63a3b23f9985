#include "registry/stats_text.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::registry {

std::string stats_text(const CatalogueStats& stats,
                       const std::vector<std::pair<std::string, std::size_t>>& by_kind,
                       const StatsInput& input) {
    constexpr std::size_t kMostKinds = 200;
    using nlohmann::json;
    json boards = json::object();
    for (std::size_t state = 0; state < kStates; ++state) {
        boards[std::string(model::to_text(static_cast<model::BoardState>(state)))] = stats.boards[state];
    }
    json kinds = json::object();
    for (std::size_t i = 0; i < by_kind.size() && i < kMostKinds; ++i)
        kinds[by_kind[i].first] = by_kind[i].second;
    json refused = json::object();
    for (std::size_t i = 0; i < kRefusals; ++i) {
        const auto reason = static_cast<Refusal>(i);
        if (reason != Refusal::kNotForUs && stats.refused[i] > 0)
            refused[std::string(to_text(reason))] = stats.refused[i];
    }
    const json document{{"version", input.version},
                        {"epoch", input.epoch},
                        {"seq", input.seq},
                        {"at", text::iso_time(input.at)},
                        {"uptime", std::round(input.uptime_seconds)},
                        {"boards", std::move(boards)},
                        {"services", std::move(kinds)},
                        {"conflicts", stats.conflicts},
                        {"messages", input.messages},
                        {"messages_per_second", std::round(input.messages_per_second * 10) / 10},
                        {"renewals", stats.renewals},
                        {"expired", stats.expired},
                        {"refused", std::move(refused)},
                        {"queries", input.queries},
                        {"events", input.events},
                        {"connections", input.connections}};
    return model::dump_json(document);
}

}  // namespace asip::registry
