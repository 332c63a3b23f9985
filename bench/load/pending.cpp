// SPDX-License-Identifier: Apache-2.0
#include "bench/load/pending.hpp"

namespace asip::load {

void Pending::add(caller::Caller::Question request, Time sent, std::size_t kind) {
    auto id = request.id();
    waiting_.emplace(std::move(id), Waiting{std::move(request), sent, kind});
}

std::vector<std::size_t> Pending::forget_overdue(Time now) {
    std::vector<std::size_t> kinds;
    std::erase_if(waiting_, [&](const auto& one) {
        const bool overdue = now - one.second.sent > kPatience;
        if (overdue) kinds.push_back(one.second.kind);
        return overdue;
    });
    return kinds;
}

std::vector<std::size_t> Pending::kinds() const {
    std::vector<std::size_t> kinds;
    for (const auto& [id, one] : waiting_)
        kinds.push_back(one.kind);
    return kinds;
}

}  // namespace asip::load
