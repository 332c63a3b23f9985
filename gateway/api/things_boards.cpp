// SPDX-License-Identifier: Apache-2.0
// Which boards are made things, and which of their values are demanded.
#include "gateway/api/things.hpp"

#include "asip/bus/registry/board_match.hpp"

namespace asip::gateway::api {

using exports::ExportedBoard;

std::optional<Things::Found> Things::find(Mirror& mirror, const std::string& name, const Instant& now) {
    bus::Query query;
    query.board = name;
    query.full = true;
    const auto answer = mirror.find(query, now);
    if (!answer || answer->boards.empty()) return std::nullopt;
    const auto& item = answer->boards[0];
    Found found{item.state, item.session, nullptr};
    auto list = mirror.standing().list(name, item.session);
    const auto hash = std::hash<std::string>()(item.description);
    if (const auto known = boards_.find(name); known != boards_.end() && known->second.hash == hash &&
                                               known->second.bytes == item.description.size() &&
                                               known->second.list == list)
        found.board = known->second.board.lock();
    if (found.board) return found;
    auto made = exports::exported_board(item, list.get(), [this](const model::ServiceInfo& service) {
        return bus::model_of(service, models_);
    });
    if (!made) return std::nullopt;
    found.board = std::make_shared<const ExportedBoard>(std::move(*made));
    if (boards_.size() >= tidy_at_) {
        std::erase_if(boards_, [](const auto& each) { return each.second.board.expired(); });
        tidy_at_ = 2 * std::max(kMaxBoards, boards_.size());
    }
    boards_[name] = {hash, item.description.size(), std::move(list), found.board};
    last_.push_back(found.board);
    if (last_.size() > kMaxBoards) last_.pop_front();
    return found;
}

bool Things::want(caller::Caller& caller, const std::string& board, const std::string& service, Time now) {
    std::erase_if(wants_, [&](const auto& each) { return each.second.until <= now; });
    const auto found = wants_.find({board, service});
    const bool is_new = found == wants_.end();
    if (is_new && wants_.size() >= kMaxWants) return true;
    auto& wanted = wants_[{board, service}];
    wanted.until = now + kWantFor;
    if (is_new) wanted.want = caller.want(board, service);
    return is_new;
}

}  // namespace asip::gateway::api
