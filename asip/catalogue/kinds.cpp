// SPDX-License-Identifier: Apache-2.0
#include "asip/catalogue/kinds.hpp"

namespace asip::catalogue {

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
