// SPDX-License-Identifier: Apache-2.0
#include "registry/history/journal.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "asip/bus/registry/answer.hpp"
#include "asip/bus/request/request_envelope.hpp"
#include "asip/model/json.hpp"
#include "asip/model/names.hpp"

namespace asip::registry {
namespace {

bus::HistoryItem row(std::string_view board, text::WallTime at, std::string_view what) {
    bus::HistoryItem item;
    item.board = board;
    item.at = at;
    item.what = what;
    return item;
}

constexpr std::size_t kMaxNoteBytes = 1024;
constexpr std::size_t kMaxWhoBytes = 256;   // a link says why, too
constexpr std::size_t kMaxTextBytes = 128;  // of a request or reason
constexpr std::size_t kMerged = 64;         // rows in which a command like this one is looked for

bool one_of(std::string_view word, std::initializer_list<std::string_view> words) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

bool is_command(const bus::HistoryItem& item) {
    return !item.by.empty() && item.by.size() <= kMaxWhoBytes &&
           one_of(item.what, {"command", "stop", "undone"}) &&
           one_of(item.status, {"ok", "sent", "error", "timeout", "refused"}) &&
           (item.service.empty() || model::valid_name(item.service)) &&
           item.request.size() <= kMaxTextBytes && item.reason.size() <= kMaxTextBytes;
}

// `{"write":` of `{"write":[0,90]}`, `W` of `W,0,90`.
std::string_view without_arguments(std::string_view request) {
    return request.substr(0, request.find_first_of(":,"));
}

// `link warm` of `link warm, because desk/temperature was 30.5`.
std::string_view without_cause(std::string_view by) {
    return by.substr(0, by.find(", because "));
}

bool alike(const bus::HistoryItem& a, const bus::HistoryItem& b) {
    return a.board == b.board && a.what == b.what && without_cause(a.by) == without_cause(b.by) &&
           a.service == b.service && a.status == b.status && a.reason == b.reason &&
           without_arguments(a.request) == without_arguments(b.request);
}

}  // namespace

const JournalBoard* Journal::find(std::string_view board) const {
    const auto found = known_.find(board);
    return found == known_.end() ? nullptr : &found->second;
}

void Journal::added(std::string_view board, model::BoardState state, std::string_view reason, Stamp at,
                    Rows& rows) {
    const auto found = known_.find(board);
    if (found != known_.end()) return came_into(found->first, found->second, state, reason, at, rows);
    known_.emplace(board, JournalBoard{at.wall, at.wall, state, at.kept, at.kept});
    rows.push_back(row(board, at.wall, "added"));
    rows.back().state = model::to_text(state);
    rows.back().reason = reason;
}

void Journal::came_into(const std::string& board, JournalBoard& known, model::BoardState state,
                        std::string_view reason, Stamp at, Rows& rows) {
    if (known.state == state) return;
    rows.push_back(row(board, at.wall, "state"));
    rows.back().was = model::to_text(known.state);
    rows.back().state = model::to_text(state);
    rows.back().reason = reason;
    known.state = state;
    known.since = at.wall;
    known.since_kept = at.kept;
}

void Journal::change(const Event& event, Stamp at, Rows& rows) {
    const std::string_view reason = to_text(event.reason);
    switch (event.kind) {
        case Event::Kind::kState:
            // The same state for another reason.
            if (!reading_ && event.was == event.state) {
                rows.push_back(row(event.board, at.wall, "state"));
                rows.back().was = rows.back().state = model::to_text(event.state);
                rows.back().reason = reason;
                return;
            }
            [[fallthrough]];
        case Event::Kind::kAdded:
            if (!reading_) added(event.board, event.state, reason, at, rows);
            return;
        case Event::Kind::kForgotten:
            known_.erase(event.board);
            rows.push_back(row(event.board, at.wall, "forgotten"));
            return;
        case Event::Kind::kDescription:
            if (reading_) return;
            [[fallthrough]];
        case Event::Kind::kConflict:
        case Event::Kind::kResolved:
            rows.push_back(
                row(event.board, at.wall, bus::to_string(static_cast<bus::ChangeEvent::Kind>(event.kind))));
            rows.back().state = model::to_text(event.state);
            return;
        default:
            return;
    }
}

void Journal::command(std::string_view board, std::string_view payload, text::WallTime at, Rows& rows) const {
    if (!known_.contains(board)) return;
    const auto object = model::parse_json(payload, {.max_bytes = kMaxNoteBytes, .max_depth = 4});
    if (!object || !object->is_object()) return;
    bus::HistoryItem item = bus::read_history_item(*object);
    item.board = board;
    item.at = at;
    item.state.clear();
    item.was.clear();
    item.count = 0;
    if (!is_command(item)) return;
    const auto end = rows.size() < kMerged ? rows.rend() : rows.rbegin() + kMerged;
    const auto same = std::find_if(rows.rbegin(), end, [&](const auto& row) { return alike(row, item); });
    if (same == end) return rows.push_back(std::move(item));
    same->request = std::move(item.request);  // the last one counts
    same->by = std::move(item.by);
    same->count = std::max(same->count, 1) + 1;
}

void Journal::complete(const Catalogue& catalogue, Stamp at, Rows& rows) {
    reading_ = false;
    catalogue.for_each([&](std::string_view board, model::BoardState state, model::StateReason reason) {
        added(board, state, to_text(reason), at, rows);
    });
}

void Journal::end_absent(const Catalogue& catalogue, Stamp at, Rows& rows) {
    for (auto& [board, known] : known_) {
        if (!model::is_there(known.state) || catalogue.knows(board)) continue;
        came_into(board, known, model::BoardState::kLost, to_text(model::StateReason::kExpired), at, rows);
    }
}

void Journal::load(JournalBoards known, std::chrono::milliseconds shift, Rows& rows) {
    // The state that the file has of a board, as the rows go on from it; nothing: it was forgotten.
    std::map<std::string, std::string, std::less<>> states;
    for (const auto& [board, of_file] : known)
        states.emplace(board, model::to_text(of_file.state));
    Rows changes;
    for (bus::HistoryItem& item : rows) {
        if (const auto before = states.find(item.board); !item.is_command() && before != states.end()) {
            const std::string was = std::exchange(before->second, item.state);
            if (item.what == "forgotten") states.erase(before);
            if (item.what == "added" && was == item.state) continue;
            if (item.what == "added") item.what = "state", item.was = was;
        } else if (!item.is_command() && item.what != "forgotten") {
            states.emplace(item.board, item.state);
        }
        changes.push_back(std::move(item));
    }
    rows = std::move(changes);
    std::erase_if(known, [&states](const auto& board) { return !states.contains(board.first); });
    for (auto& [board, now] : known_) {
        now.first_kept += shift;
        now.since_kept += shift;
        const auto of_file = known.find(board);
        if (of_file == known.end()) continue;
        if (now.state == of_file->second.state) {
            now = of_file->second;
        } else {
            now.first = of_file->second.first;
            now.first_kept = of_file->second.first_kept;
        }
    }
    known_.merge(known);
}

}  // namespace asip::registry
