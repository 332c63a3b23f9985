// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "asip/catalogue/catalogue_impl.hpp"

namespace asip::catalogue {

// Several sorted sets are read side by side.
void Catalogue::Impl::visit_candidates(const QueryPlan& plan,
                                       const std::function<bool(std::uint32_t slot)>& visit) const {
    struct Source {
        const SlotList* list;
        SlotList::Position at;
    };
    std::vector<Source> sources;
    const std::string_view prefix = plan.name_prefix();
    const bool from_cursor = plan.cursor && plan.in_order_of_names();
    const std::string_view from =
        std::max(from_cursor ? std::string_view(plan.cursor->board) : std::string_view(), prefix);
    const auto before = [&](std::uint32_t slot) { return board(slot).name < from; };
    const auto add = [&](const SlotList& list) {
        const auto at = from.empty() ? SlotList::Position{} : list.lower_bound(before);
        if (!list.at_end(at)) sources.push_back({&list, at});
    };
    for (const model::BoardState state : plan.states) {
        if (plan.query.kind.empty()) add(all_[index_of(state)].list());
        for (const Kind* kind : plan.kinds)
            add(kind->boards[index_of(state)].list());
    }
    while (!sources.empty()) {
        std::uint32_t next = NameTable::kNone;
        for (const Source& source : sources) {
            const std::uint32_t slot = source.list->at(source.at);
            if (next == NameTable::kNone || order_.label(slot) < order_.label(next)) next = slot;
        }
        for (std::size_t i = 0; i < sources.size();) {
            Source& source = sources[i];
            if (source.list->at(source.at) == next) source.list->step(source.at);
            if (source.list->at_end(source.at)) {
                sources.erase(sources.begin() + static_cast<std::ptrdiff_t>(i));
            } else {
                ++i;
            }
        }
        const std::string_view name = board(next).name;
        if (!prefix.empty() && name.substr(0, prefix.size()) != prefix) return;
        if (!visit(next)) return;
    }
}

}  // namespace asip::catalogue
