// SPDX-License-Identifier: Apache-2.0
#include "asip/session/service_table.hpp"

#include <algorithm>

namespace asip::session {

ServiceTable::ServiceTable(const Identity& board, const model::ModelSet& models) {
    for (const auto& service : board.services) {
        Entry entry{service.id, std::string(1, service.id), service.name,
                    models.match(service.id, service.name)};
        if (entry.model && find(entry.model->name) == nullptr) entry.name = entry.model->name;
        entries_.push_back(std::move(entry));
    }
}

const ServiceTable::Entry* ServiceTable::find(char letter) const {
    auto it =
        std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.letter == letter; });
    return it == entries_.end() ? nullptr : &*it;
}

const ServiceTable::Entry* ServiceTable::find(std::string_view name) const {
    auto it = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.name == name; });
    return it == entries_.end() ? nullptr : &*it;
}

}  // namespace asip::session
