// SPDX-License-Identifier: Apache-2.0
#include "gateway/api/board_models.hpp"

#include <nlohmann/json.hpp>

#include "asip/bus/json/json_text.hpp"
#include "asip/bus/registry/board_match.hpp"
#include "asip/model/description.hpp"
#include "asip/model/json.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::gateway::api {

namespace {

// A description that is wrong in one service's own model says the others' all the same.
model::ServiceInfo info_of(const bus::ServiceItem& service) {
    model::ServiceInfo info;
    info.name = service.name;
    info.id = service.id.empty() ? '\0' : service.id.front();
    info.model = service.model;
    return info;
}

// Times on the wall are reckoned anew from steady ones, and may come out a millisecond apart.
void keep_steady(text::WallTime& kept, text::WallTime now) {
    if (now - kept > std::chrono::milliseconds(1) || kept - now > std::chrono::milliseconds(1)) return;
    kept = now;
}

}  // namespace

model::ModelPtr BoardModels::find(const bus::BoardItem& board, std::string_view service,
                                  const Description& description) {
    if (bytes_ > max_bytes_ || (entries_.size() >= kMaxBoards && !entries_.contains(board.board))) {
        entries_.clear();
        bytes_ = 0;
    }
    Entry& entry = entries_[board.board];
    const bool known = !entry.services.empty() && entry.session == board.session && entry.seq == board.seq &&
                       entry.services == board.services;
    if (!known) {
        bytes_ -= entry.bytes;
        entry = {board.session, board.seq, board.services, {}, 0};
        const auto text = description();
        // A model of a board's own takes several times the bytes of its text.
        entry.bytes = 8 * text.size() + sizeof(Entry) + board.services.size() * 2 * sizeof(bus::ServiceItem);
        bytes_ += entry.bytes;
        const auto parsed = model::parse_description(text);
        for (const auto& each : board.services)
            if (text.empty())
                entry.models[each.name] = models_.find(each.name);
            else if (const auto* info = parsed ? parsed->service(each.name) : nullptr)
                entry.models[each.name] = bus::model_of(*info, models_);
            else if (!parsed)
                entry.models[each.name] = bus::model_of(info_of(each), models_);
    }
    const auto found = entry.models.find(service);
    return found == entry.models.end() ? nullptr : found->second;
}

void BoardTexts::make_room_for(const std::string& board) {
    const bool full = bytes_ > max_bytes_ || (entries_.size() >= kMaxBoards && !entries_.contains(board));
    if (!full) return;
    entries_.clear();
    bytes_ = 0;
}

std::string BoardTexts::text(const bus::BoardItem& board) {
    make_room_for(board.board);
    Entry& entry = entries_[board.board];
    entry.board.age = board.age;
    entry.board.last_seen = board.last_seen;
    entry.board.state_age = board.state_age;
    keep_steady(entry.board.first_seen, board.first_seen);
    keep_steady(entry.board.since, board.since);
    if (entry.rest.empty() || !(entry.board == board)) {
        entry.board = board;
        auto object = bus::to_json(board);
        object.erase("age");
        object.erase("last_seen");
        object.erase("state_age");
        entry.rest = model::dump_json(object).substr(1);
        // The item holds the same texts again, and a few hundred bytes for each of its services.
        const std::size_t bytes =
            2 * entry.rest.capacity() + sizeof(Entry) + board.services.size() * sizeof(bus::ServiceItem);
        bytes_ += bytes - entry.bytes;
        entry.bytes = bytes;
    }
    std::string text = "{";
    if (board.last_seen != text::WallTime{}) {
        text += R"("age":)";
        bus::append_json_seconds(text, board.age);
        text += R"(,"last_seen":")" + text::iso_time(board.last_seen) + "\",";
    }
    if (board.state_age >= 0) {
        text += R"("state_age":)";
        bus::append_json_seconds(text, board.state_age);
        text += ',';
    }
    return text + entry.rest;
}

}  // namespace asip::gateway::api
