// SPDX-License-Identifier: Apache-2.0
#include "bench/load/changes.hpp"

#include <algorithm>

namespace asip::load {

void EventNumbers::take(const std::string& of_epoch, std::uint64_t number, bool reset) {
    const bool first = epoch != of_epoch;
    if (reset) {
        if (!first) ++resets;
    } else if (!first && number != seq + 1) {
        ++gaps;
        if (number > seq) left_out += number - seq - 1;
    }
    epoch = of_epoch;
    seq = number;
}

void Changes::take(std::size_t watcher, std::string_view payload, Time now) {
    drop_old(now);
    Change* change = known(payload, now);
    if (change == nullptr) return;
    change->last = now;
    auto& registry = registries_[change->registry];
    ++registry.seen.events;
    registry.of_watchers[watcher].take(change->epoch, change->seq, change->reset);
}

Changes::Change* Changes::known(std::string_view payload, Time now) {
    const auto hash = std::hash<std::string_view>{}(payload);
    const auto found = changes_.find(hash);
    if (found != changes_.end()) return &found->second;
    const auto event = bus::parse_change_event(payload);
    if (!event) return nullptr;
    const auto registry = registry_of(event->registry);
    if (!registry) return nullptr;
    auto& of = registries_[*registry];
    Change change{*registry, event->epoch, event->seq, event->kind == bus::ChangeEvent::Kind::kReset,
                  {},        now};
    if (of.old_epoch == event->epoch && event->seq <= of.old_seq) {
        ++of.seen.very_late;
    } else {
        ++of.seen.different;
        change.happened = happened_(*event);
        if (change.happened) of.seen.first.add(now - *change.happened);
    }
    kept_.push_back({hash, now});
    return &changes_.emplace(hash, std::move(change)).first->second;
}

std::optional<std::size_t> Changes::registry_of(const std::string& id) {
    const auto found = std::find_if(registries_.begin(), registries_.end(),
                                    [&](const Registry& registry) { return registry.id == id; });
    if (found != registries_.end()) return static_cast<std::size_t>(found - registries_.begin());
    if (registries_.size() >= kMaxRegistries) return std::nullopt;
    registries_.push_back({id, {}, std::vector<EventNumbers>(watchers_)});
    return registries_.size() - 1;
}

void Changes::drop_old(Time now) {
    while (!kept_.empty() && (kept_.size() > max_kept_ || now - kept_.front().since > kKept)) {
        const auto found = changes_.find(kept_.front().hash);
        kept_.pop_front();
        auto& change = found->second;
        auto& registry = registries_[change.registry];
        if (change.happened) registry.seen.last.add(change.last - *change.happened);
        if (registry.old_epoch != change.epoch || registry.old_seq < change.seq) {
            registry.old_epoch = change.epoch;
            registry.old_seq = change.seq;
        }
        changes_.erase(found);
    }
}

void Changes::forget(std::size_t watcher) {
    for (auto& registry : registries_)
        registry.of_watchers[watcher].forget();
}

std::map<std::string, SeenChanges> Changes::seen() const {
    std::map<std::string, SeenChanges> all;
    for (const auto& registry : registries_) {
        auto& seen = all[registry.id] = registry.seen;
        for (const auto& watcher : registry.of_watchers) {
            seen.resets += watcher.resets;
            seen.gaps += watcher.gaps;
            seen.left_out += watcher.left_out;
        }
    }
    for (const auto& [hash, change] : changes_)
        if (change.happened) all[registries_[change.registry].id].last.add(change.last - *change.happened);
    return all;
}

}  // namespace asip::load
