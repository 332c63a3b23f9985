// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/registry/query.hpp"
#include "asip/catalogue/board.hpp"
#include "asip/catalogue/catalogue.hpp"
#include "asip/expected.hpp"

namespace asip::catalogue {

/// Where the previous page ended, as text "BOARD/SERVICE/KEY": names hold no '/', and sort keys come last.
struct Cursor {
    std::string board, service, key;

    std::string text() const { return board + '/' + service + '/' + key; }
};

/// A checked query, with everything looked up. Lives as long as `query` and the table of kinds.
struct QueryPlan {
    enum class Sort { kName, kState, kChip, kSketch, kLastSeen };

    const bus::Query& query;
    const View* view = nullptr;               ///< of the asker; null: sees everything
    std::vector<Kind*> kinds{};               ///< those of `query.kind` that exist
    std::vector<model::BoardState> states{};  ///< all of them where the query names none
    bus::Query without_states{};              ///< states are found by an index
    Sort sort = Sort::kName;
    bool descending = false;
    std::optional<Cursor> cursor{};
    std::size_t limit = 0;    ///< 1 to bus::Query::kMaxPage
    bool by_service = false;  ///< some filter looks at services

    /// A prefix of every board that can match.
    std::string_view name_prefix() const {
        return std::string_view(query.board).substr(0, query.board.find_first_of("*?"));
    }
    bool in_order_of_names() const { return sort == Sort::kName && !descending; }
    bool board_matches(const Board& b) const;
    /// `part`: the services of `b`.
    bool service_matches(const Board& b, const ServicesPart& part, std::size_t index) const;
    bool sees(const Board& b, const Service& service) const {
        return view == nullptr || !view->service || view->service(b.name, service.name);
    }
    bool some_service_matches(const Board& b) const;
    /// True: indices answer all filters by themselves, so that their sizes are the total.
    bool counted_by_index() const;
};

/// Error: a sentence that names the wrong member. `kinds` is settled. `view` may be null.
Expected<QueryPlan> make_query_plan(const bus::Query& query, const KindTable& kinds, const View* view);

}  // namespace asip::catalogue
