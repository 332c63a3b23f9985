// SPDX-License-Identifier: Apache-2.0
#include "asip/catalogue/name_order.hpp"

namespace asip::catalogue {

void BoardSet::settle(const NameOrder& order) {
    if (pending_.empty()) return;
    const auto less = [&order](std::uint32_t a, std::uint32_t b) { return order.label(a) < order.label(b); };
    if (pending_.size() < 16 + list_.size() / 16) {
        for (const auto& [slot, add] : pending_) {
            if (add) {
                list_.insert(slot, less);
            } else {
                list_.erase(slot, less);
            }
        }
    } else {
        // A slot's additions and removals alternate, so only an odd one out has an effect: that of the
        // first.
        std::stable_sort(pending_.begin(), pending_.end(),
                         [&](const auto& a, const auto& b) { return less(a.first, b.first); });
        std::vector<std::uint32_t> added;
        std::vector<std::uint32_t> removed;
        for (std::size_t i = 0; i < pending_.size();) {
            std::size_t end = i;
            while (end < pending_.size() && pending_[end].first == pending_[i].first)
                ++end;
            if ((end - i) % 2 == 1) (pending_[i].second ? added : removed).push_back(pending_[i].first);
            i = end;
        }
        list_.merge(added, removed, less);
    }
    pending_.clear();
    if (pending_.capacity() > 1024) pending_.shrink_to_fit();
}

Kind* KindTable::refer(std::string_view name, std::string_view model) {
    auto& kind = kinds_[std::string(name)];
    if (!kind) {
        kind = std::make_unique<Kind>();
        kind->name = name;
    }
    if (kind->units.empty() && !model.empty() && units_of_) kind->units = units_of_(model);
    ++kind->references;
    return kind.get();
}

void KindTable::release(Kind* kind) {
    if (--kind->references == 0 && !kind->dirty) kinds_.erase(std::string(kind->name));
}

void KindTable::mark_dirty(Kind* kind) {
    if (kind->dirty) return;
    kind->dirty = true;
    dirty_.push_back(kind);
}

void KindTable::settle(const NameOrder& order) {
    for (Kind* kind : dirty_) {
        kind->dirty = false;
        if (kind->references == 0) {
            kinds_.erase(std::string(kind->name));
            continue;
        }
        for (BoardSet& set : kind->boards)
            set.settle(order);
    }
    dirty_.clear();
}

Kind* KindTable::find(std::string_view name) const {
    const auto found = kinds_.find(std::string(name));
    return found == kinds_.end() ? nullptr : found->second.get();
}

}  // namespace asip::catalogue
