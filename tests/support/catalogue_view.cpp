// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catalogue_view.hpp"

#include <utility>

#include "asip/bus/pattern.hpp"

namespace asip::bus {

namespace {

bool differs(const BoardItem& a, const BoardItem& b) {
    return a.state != b.state || a.session != b.session || a.services != b.services ||
           a.conflict != b.conflict;
}

}  // namespace

CatalogueView::CatalogueView(OnChange on_change, std::string pattern)
    : on_change_(std::move(on_change)), pattern_(std::move(pattern)) {}

std::optional<Query> CatalogueView::next_query() const {
    if (!collecting_) return std::nullopt;
    Query query;
    query.board = pattern_;
    query.limit = Query::kMaxPage;
    query.cursor = cursor_;
    return query;
}

void CatalogueView::restart() {
    collecting_ = true;
    complete_ = false;
    cursor_.clear();
    incoming_.clear();
    page_ends_.clear();
    waiting_.clear();
    registry_.clear();
    epoch_.clear();
}

bool CatalogueView::page(const Answer& answer) {
    if (!collecting_ || !answer.refused.empty()) return false;
    const bool first = cursor_.empty();
    if (!first && answer.registry != registry_) return false;
    if (!first && answer.epoch != epoch_) {
        restart();
        return true;
    }
    if (first) {
        registry_ = answer.registry;
        epoch_ = answer.epoch;
        incoming_.clear();
        page_ends_.clear();
    }
    for (const BoardItem& item : answer.boards)
        incoming_.insert_or_assign(item.board, item);
    cursor_ = answer.cursor;
    if (!cursor_.empty() && !answer.boards.empty()) {
        page_ends_[answer.boards.back().board] = answer.seq;
        return true;
    }
    page_ends_["\x7f"] = answer.seq;  // behind every name
    finish_snapshot();
    return true;
}

// What differs between the boards before and the new snapshot is reported as changes; then the events that
// are newer than the page their board was in.
void CatalogueView::finish_snapshot() {
    auto before = std::exchange(boards_, std::exchange(incoming_, {}));
    collecting_ = false;
    complete_ = true;
    cursor_.clear();
    for (const auto& [name, item] : before)
        if (boards_.count(name) == 0) notify(ChangeEvent::Kind::kForgotten, item, {}, {});
    for (const auto& [name, item] : boards_) {
        const auto old = before.find(name);
        if (old == before.end())
            notify(ChangeEvent::Kind::kAdded, item, {}, {});
        else if (old->second.state != item.state)
            notify(ChangeEvent::Kind::kState, item, old->second.state, {});
        else if (old->second.session != item.session || old->second.services != item.services)
            notify(ChangeEvent::Kind::kDescription, item, {}, {});
    }
    seq_ = page_ends_.begin()->second;
    for (const auto& [name, seq] : page_ends_)
        seq_ = std::min(seq_, seq);
    for (const ChangeEvent& waiting : std::exchange(waiting_, {})) {
        event(waiting);
        if (collecting_) return;
    }
}

void CatalogueView::event(const ChangeEvent& event) {
    if (collecting_) {
        // Before the first page it is not known whose events matter; a registry that reports more than this
        // while it answers one query makes the next snapshot necessary anyway.
        constexpr std::size_t kMostWaiting = 100'000;
        if (waiting_.size() < kMostWaiting) waiting_.push_back(event);
        return;
    }
    if (event.registry != registry_) return;
    if (event.epoch == epoch_ && event.seq <= seq_) return;
    if (event.epoch != epoch_ || event.seq != seq_ + 1 || event.kind == ChangeEvent::Kind::kReset) {
        restart();
        return;
    }
    seq_ = event.seq;
    const auto page = page_ends_.lower_bound(event.board.board);
    if (page != page_ends_.end() && event.seq <= page->second) return;  // already in its board's page
    if (!matches_pattern(pattern_, event.board.board)) return;
    apply(event);
}

/// In a burst, a snapshot may hold changes before their events come.
void CatalogueView::apply(const ChangeEvent& event) {
    const auto known = boards_.find(event.board.board);
    if (event.kind == ChangeEvent::Kind::kForgotten) {
        if (known == boards_.end()) return;
        boards_.erase(known);
    } else {
        const bool news = known == boards_.end() || differs(known->second, event.board) ||
                          event.kind == ChangeEvent::Kind::kDescription;
        boards_.insert_or_assign(event.board.board, event.board);
        if (!news) return;
    }
    notify(event.kind, event.board, event.was, event.reason);
}

void CatalogueView::notify(ChangeEvent::Kind kind, const BoardItem& board, std::string was,
                           std::string reason) {
    if (on_change_) on_change_(Change{kind, board, std::move(was), std::move(reason)});
}

}  // namespace asip::bus
