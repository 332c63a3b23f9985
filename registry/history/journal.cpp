#include "registry/history/journal.hpp"

#include "asip/bus/change_event.hpp"

namespace asip::registry {
namespace {

bool is_alive(model::BoardState state) {
    return state != model::BoardState::kOffline && state != model::BoardState::kLost;
}

bus::HistoryItem row(std::string_view board, text::WallTime at, std::string_view what) {
    bus::HistoryItem item;
    item.board = board;
    item.at = at;
    item.what = what;
    return item;
}

}  // namespace

const JournalBoard* Journal::find(std::string_view board) const {
    const auto found = known_.find(board);
    return found == known_.end() ? nullptr : &found->second;
}

void Journal::added(std::string_view board, model::BoardState state, std::string_view reason,
                    text::WallTime at, Rows& rows) {
    const auto found = known_.find(board);
    if (found != known_.end()) return came_into(found->first, found->second, state, reason, at, rows);
    known_.emplace(board, JournalBoard{at, at, state});
    rows.push_back(row(board, at, "added"));
    rows.back().state = model::to_text(state);
    rows.back().reason = reason;
}

void Journal::came_into(const std::string& board, JournalBoard& known, model::BoardState state,
                        std::string_view reason, text::WallTime at, Rows& rows) {
    if (known.state == state) return;
    rows.push_back(row(board, at, "state"));
    rows.back().was = model::to_text(known.state);
    rows.back().state = model::to_text(state);
    rows.back().reason = reason;
    known.state = state;
    known.since = at;
}

void Journal::change(const Event& event, text::WallTime at, Rows& rows) {
    const std::string_view reason = to_text(event.reason);
    switch (event.kind) {
        case Event::Kind::kAdded:
        case Event::Kind::kState:
            if (!reading_) added(event.board, event.state, reason, at, rows);
            return;
        case Event::Kind::kForgotten:
            known_.erase(event.board);
            rows.push_back(row(event.board, at, "forgotten"));
            return;
        case Event::Kind::kDescription:
            if (reading_) return;
            [[fallthrough]];
        case Event::Kind::kConflict:
        case Event::Kind::kResolved:
            rows.push_back(
                row(event.board, at, bus::to_string(static_cast<bus::ChangeEvent::Kind>(event.kind))));
            rows.back().state = model::to_text(event.state);
            return;
        default:
            return;
    }
}

void Journal::complete(const Catalogue& catalogue, text::WallTime at, Rows& rows) {
    reading_ = false;
    catalogue.for_each([&](std::string_view board, model::BoardState state) {
        added(board, state, to_text(Event::Reason::kRetained), at, rows);
    });
}

void Journal::end_absent(const Catalogue& catalogue, text::WallTime at, Rows& rows) {
    for (auto& [board, known] : known_) {
        if (!is_alive(known.state) || catalogue.knows(board)) continue;
        came_into(board, known, model::BoardState::kLost, to_text(Event::Reason::kLease), at, rows);
    }
}

}  // namespace asip::registry
