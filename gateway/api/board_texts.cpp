// SPDX-License-Identifier: Apache-2.0
#include "gateway/api/board_texts.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::gateway::api {
namespace {

// Times on the wall are reckoned anew from steady ones, and may come out a millisecond apart.
void keep_steady(text::WallTime& kept, text::WallTime now) {
    if (now - kept > std::chrono::milliseconds(1) || kept - now > std::chrono::milliseconds(1)) return;
    kept = now;
}

}  // namespace

std::string BoardTexts::text(const bus::BoardItem& board) {
    if (entries_.size() >= kMaxBoards && !entries_.contains(board.board)) entries_.clear();
    Entry& entry = entries_[board.board];
    entry.board.age = board.age;
    entry.board.last_seen = board.last_seen;
    keep_steady(entry.board.first_seen, board.first_seen);
    keep_steady(entry.board.since, board.since);
    if (entry.rest.empty() || !(entry.board == board)) {
        entry.board = board;
        auto object = bus::to_json(board);
        object.erase("age");
        object.erase("last_seen");
        entry.rest = model::dump_json(object).substr(1);
    }
    if (board.last_seen == text::WallTime{}) return "{" + entry.rest;
    char age[40];
    std::snprintf(age, sizeof age, "{\"age\":%.3f",
                  static_cast<double>(static_cast<long long>(board.age * 1000)) / 1000);
    return age + (",\"last_seen\":\"" + text::iso_time(board.last_seen) + "\",") + entry.rest;
}

}  // namespace asip::gateway::api
