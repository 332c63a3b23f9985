// SPDX-License-Identifier: Apache-2.0
#include "gateway/api/board_models.hpp"

#include "asip/bus/registry/board_match.hpp"
#include "asip/model/description.hpp"

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
        for (const auto& each : board.services) {
            if (text.empty()) {
                entry.models[each.name] = models_.find(each.name);
            } else if (const auto* info = parsed ? parsed->service(each.name) : nullptr) {
                entry.models[each.name] = bus::model_of(*info, models_);
            } else if (!parsed) {
                entry.models[each.name] = bus::model_of(info_of(each), models_);
            }
        }
    }
    const auto found = entry.models.find(service);
    return found == entry.models.end() ? nullptr : found->second;
}

}  // namespace asip::gateway::api
