// SPDX-License-Identifier: Apache-2.0
#include "asip/catalogue/catalogue.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "asip/bus/pattern.hpp"
#include "asip/catalogue/catalogue_impl.hpp"

namespace asip::catalogue {

std::string_view to_text(Refusal refusal) {
    static constexpr std::array<std::string_view, kRefusals> kWords{
        "not-for-us",   "bad-name",    "bad-state", "too-long", "malformed", "wrong-board",
        "old-sequence", "old-session", "unproven",  "conflict", "old-hint",  "too-many"};
    return kWords.at(static_cast<std::size_t>(refusal));
}

Catalogue::Impl::Impl(Options options)
    : options_(std::move(options)),
      kinds_(options_.units_of),
      firmwares_(options_.hash_seed),
      pins_(options_.hash_seed),
      services_(options_.hash_seed) {}

Catalogue::Impl::~Impl() = default;

Catalogue::Catalogue() : Catalogue(Options{}) {}
Catalogue::Catalogue(Options options) : impl_(std::make_unique<Impl>(std::move(options))) {}
Catalogue::~Catalogue() = default;

Applied Catalogue::apply(const Announcement& announcement, Time now) {
    return impl_->apply(announcement, now);
}
std::vector<Event> Catalogue::expire(Time now, std::size_t most) {
    return impl_->expire(now, most);
}

std::optional<Time> Catalogue::next_expiry() const {
    return impl_->suspended_ ? std::nullopt : impl_->wheel_.next();
}

void Catalogue::suspend() {
    impl_->suspended_ = true;
}
void Catalogue::resume(Time now) {
    impl_->resume(now);
}
bool Catalogue::suspended() const {
    return impl_->suspended_;
}

Expected<std::vector<Event>, Catalogue::NotForgotten> Catalogue::forget(std::string_view board, Time now) {
    return impl_->forget(board, now);
}

Expected<bus::Answer> Catalogue::find(const bus::Query& query, Instant now, const View* view) {
    return impl_->find(query, now, view);
}

std::optional<bus::BoardItem> Catalogue::board(std::string_view name, Instant now, bool full) const {
    const std::uint32_t slot = impl_->slot_of(name);
    if (slot == NameTable::kNone) return std::nullopt;
    return impl_->board_item(impl_->board(slot), now, full);
}

std::vector<std::string> Catalogue::names(const std::string& pattern, const std::string& after,
                                          std::size_t max) {
    return impl_->names(pattern, after, max);
}

std::vector<std::string> Catalogue::forgettable(std::string_view pattern) const {
    std::vector<std::string> names;
    for (std::uint32_t slot = 0; slot < impl_->slots_; ++slot) {
        const Board& b = impl_->board(slot);
        if (b.in_use && !model::is_there(b.effective) && bus::matches_pattern(pattern, b.name))
            names.push_back(b.name);
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::uint64_t Catalogue::seq() const {
    return impl_->seq_;
}
std::size_t Catalogue::size() const {
    return impl_->names_.size();
}

bool Catalogue::knows(std::string_view board) const {
    return impl_->slot_of(board) != NameTable::kNone;
}

void Catalogue::for_each(
    const std::function<void(std::string_view, model::BoardState, model::StateReason)>& visit) const {
    for (std::uint32_t slot = 0; slot < impl_->slots_; ++slot) {
        const Board& b = impl_->board(slot);
        if (b.in_use) visit(b.name, b.effective, b.reason);
    }
}

void Catalogue::count_refused(Refusal refusal) {
    ++impl_->stats_.refused[static_cast<std::size_t>(refusal)];
}

CatalogueStats Catalogue::stats() const {
    CatalogueStats stats = impl_->stats_;
    for (std::size_t state = 0; state < kStates; ++state)
        stats.boards[state] = impl_->all_[state].size();
    return stats;
}

std::vector<std::pair<std::string, std::size_t>> Catalogue::services_by_kind() const {
    std::vector<std::pair<std::string, std::size_t>> counts;
    for (const auto& [name, kind] : impl_->kinds_.all()) {
        std::size_t count = 0;
        for (const std::size_t in_state : kind->services)
            count += in_state;
        if (count > 0) counts.emplace_back(name, count);
    }
    std::sort(counts.begin(), counts.end());
    return counts;
}

std::vector<std::pair<std::string, std::size_t>> Catalogue::services_by_kind(const View& view) const {
    if (!view.board && !view.service) return services_by_kind();
    std::map<std::string, std::size_t> counts;
    for (std::uint32_t slot = 0; slot < impl_->slots_; ++slot) {
        const Board& b = impl_->board(slot);
        if (!b.in_use || b.services == nullptr || (view.board && !view.board(b.name))) continue;
        for (const Service& service : b.services->services)
            if (!view.service || view.service(b.name, service.name)) ++counts[service.kind->name];
    }
    return {counts.begin(), counts.end()};
}

std::array<std::size_t, kStates> Catalogue::boards_by_state(const View& view) const {
    if (!view.board) return stats().boards;
    std::array<std::size_t, kStates> counts{};
    for_each([&](std::string_view board, model::BoardState state, model::StateReason) {
        if (!view.board || view.board(board)) ++counts[index_of(state)];
    });
    return counts;
}

std::size_t Catalogue::out_of_date(const View& view) const {
    std::size_t count = 0;
    for (std::uint32_t slot = 0; slot < impl_->slots_; ++slot) {
        const Board& b = impl_->board(slot);
        if (b.in_use && b.effective == model::BoardState::kOnline && b.firmware != nullptr &&
            !b.firmware->available.empty() && (!view.board || view.board(b.name)))
            ++count;
    }
    return count;
}

void Catalogue::settle() {
    impl_->settle();
}

}  // namespace asip::catalogue
