// SPDX-License-Identifier: Apache-2.0
// What registries have kept: changes, and values.
#include <algorithm>
#include <chrono>
#include <optional>
#include <set>

#include "asip/bus/registry/longest.hpp"
#include "cli/ask/board_source.hpp"

namespace asip::cli {
Outcome<std::vector<bus::HistoryItem>> BoardSource::history(bus::Query query, std::size_t count,
                                                            text::WallTime since) {
    query.find = bus::Find::kHistory;
    const auto older = [since](const bus::HistoryItem& change) { return change.at < since; };
    std::vector<bus::HistoryItem> all;
    answered_bytes_ = 0;
    // Another one than the registry that answered before may be the one that keeps it.
    const auto other = std::exchange(registry_, {});
    do {
        query.limit = std::min(count - all.size(), bus::Query::kMaxPage);
        auto page = ask(query);
        if (!page && page.error().status == program::kExitNoAnswer) {
            return failure(program::kExitNoAnswer,
                           "no registry answers; only asip-registry --history FILE keeps a history");
        }
        if (!page) return tl::unexpected(page.error());
        if (goes_on_for_ever(*page, query.cursor, page->history.empty())) return without_end();
        std::move(page->history.begin(), page->history.end(), std::back_inserter(all));
        query.cursor = page->cursor;
    } while (!query.cursor.empty() && all.size() < count && !older(all.back()));
    std::erase_if(all, older);
    if (!other.empty()) registry_ = other;
    return all;
}

/// Each registry keeps for itself: all that are online are asked.
Outcome<bus::Answer> BoardSource::values(bus::Query query) {
    query.find = bus::Find::kValues;
    if (online_registries_.empty()) session_.wait_retained();
    std::set<std::string> all(online_registries_.begin(), online_registries_.end());
    if (all.size() < 2) all = {""};  // whichever answers
    std::optional<Outcome<bus::Answer>> best;
    std::string kept_by;
    for (const auto& each : all) {
        registry_ = each;
        auto answer = query.property.empty() ? ask_all_pages(query) : ask(query);
        if (session_.stopped()) return interrupted();
        if (answer && best && *best && query.property.empty()) {
            auto& kept = (*best)->kept;
            for (auto& one : answer->kept)
                if (std::find(kept.begin(), kept.end(), one) == kept.end()) kept.push_back(std::move(one));
        } else if (!best || (answer && (!*best || bus::known_time(*answer, query.to) >
                                                      bus::known_time(**best, query.to)))) {
            best = std::move(answer);
            kept_by = each;
        }
    }
    registry_.clear();
    if (!*best && best->error().status == program::kExitNoAnswer)
        return failure(program::kExitNoAnswer,
                       "no registry answers; only asip-registry --history FILE keeps values");
    if (*best && all.size() > 1 && !query.property.empty())
        environment_.note("of " + std::to_string(all.size()) + " registries, " + kept_by +
                          " kept it for the longest");
    return std::move(*best);
}

}  // namespace asip::cli
