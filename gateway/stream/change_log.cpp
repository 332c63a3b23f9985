// SPDX-License-Identifier: Apache-2.0
#include "gateway/stream/change_log.hpp"

#include "gateway/stream/change_feed.hpp"

namespace asip::gateway {

ChangeLog::~ChangeLog() {
    for (auto* feed : feeds_)
        feed->log_ = nullptr;
}

void ChangeLog::add(std::string_view kind, std::string board, std::string data) {
    bytes_ += sizeof(Change) + board.size() + data.size();
    changes_.push_back({++last_, kind, std::move(board), std::move(data)});
    while (bytes_ > max_bytes_ && changes_.size() > 1) {
        bytes_ -= sizeof(Change) + changes_.front().board.size() + changes_.front().data.size();
        changes_.pop_front();
    }
    for (auto* feed : feeds_)
        feed->wake();
}

const ChangeLog::Change* ChangeLog::change(std::uint64_t number) const {
    if (changes_.empty() || number < changes_.front().number || number > last_) return nullptr;
    return &changes_[static_cast<std::size_t>(number - changes_.front().number)];
}

}  // namespace asip::gateway
