// SPDX-License-Identifier: Apache-2.0
#include "gateway/stream/change_log.hpp"

#include <algorithm>

#include "asip/bus/pattern.hpp"

namespace asip::gateway {

namespace {

constexpr std::size_t kBytes = 2 * 1024;  // of a feed itself, with the rights that it was made for

}  // namespace

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

ChangeFeed::ChangeFeed(ChangeLog& log, ReadPage read_page, Options options)
    : log_(&log),
      read_page_(std::move(read_page)),
      pattern_(std::move(options.board)),
      allowed_(std::move(options.allowed)),
      part_(std::move(options.part)) {
    if (!part_.set(kBytes)) fault_ = kTooMuchKept;
    sent_ = placed_ = log.last();
    if (options.after) {
        const bool epoch = options.after->epoch == log.epoch();
        const auto number = options.after->number;
        if (epoch && (number == log.last() || (number < log.last() && log.change(number + 1) != nullptr))) {
            sent_ = placed_ = number;
        } else {
            reset_reason_ = epoch ? "past-gone" : "another-epoch";
            phase_ = Phase::kReset;
        }
    } else if (options.snapshot) {
        begin_snapshot();
    }
    log.feeds_.push_back(this);
}

ChangeFeed::~ChangeFeed() {
    if (log_ == nullptr) return;
    auto& feeds = log_->feeds_;
    feeds.erase(std::remove(feeds.begin(), feeds.end(), this), feeds.end());
}

void ChangeFeed::begin_snapshot() {
    phase_ = Phase::kSnapshot;
    sent_ = log_->last();
    page_ = {{}, {}, false};
    at_ = 0;
    turn_over_ = true;
    last_name_.clear();
    pages_.clear();
}

bool ChangeFeed::matches(const ChangeLog::Change& change) const {
    if (change.board.empty()) return true;
    return bus::matches_pattern(pattern_, change.board) && (!allowed_ || allowed_(change.board));
}

bool ChangeFeed::in_snapshot(const ChangeLog::Change& change) const {
    for (const auto& [last, number] : pages_)
        if (change.board <= last) return change.number <= number;
    return false;
}

void ChangeFeed::tick(const Instant& now) {
    if (phase_ != Phase::kLive || placed_ == sent_ || now.time - quiet_since_ < kBookmarkTime) return;
    bookmark_due_ = true;
    wake();
}

bool ChangeFeed::next(StreamEvent& event, const Instant& now) {
    if (log_ == nullptr || !fault_.empty()) return false;
    if (phase_ == Phase::kLive && log_->last() > sent_ && log_->change(sent_ + 1) == nullptr) {
        reset_reason_ = "too-slow";
        phase_ = Phase::kReset;
    }
    if (phase_ == Phase::kReset) {
        begin_snapshot();
        event = {"reset", {}, R"({"reason":")" + std::string(reset_reason_) + "\"}"};
        return true;
    }
    return phase_ == Phase::kSnapshot ? next_board(event, now) : next_change(event, now);
}

bool ChangeFeed::next_board(StreamEvent& event, const Instant& now) {
    if (at_ == page_.boards.size() && !page_.last) {
        if (!turn_over_) return !(turn_over_ = true);
        turn_over_ = false;
        if (!read_page(now)) return false;
    }
    if (at_ < page_.boards.size()) {
        event = {"board", {}, R"({"board":)" + page_.boards[at_++] + "}"};
        return true;
    }
    if (!page_.last) return !(turn_over_ = true);  // all that was looked at is hidden from this reader
    page_ = {};
    part_.set(std::min(part_.bytes(), kBytes + pages_.size() * sizeof pages_[0]));
    phase_ = Phase::kLive;
    placed_ = sent_;
    quiet_since_ = now.time;
    event = {"snapshot-end", Place{log_->epoch(), sent_}.text(), "{}"};
    return true;
}

bool ChangeFeed::read_page(const Instant& now) {
    page_ = read_page_(pattern_, last_name_, now);
    at_ = 0;
    std::size_t bytes = kBytes + pages_.size() * sizeof pages_[0];
    for (const auto& board : page_.boards)
        bytes += sizeof board + board.capacity();
    if (!part_.set(bytes)) {
        fault_ = kTooMuchKept;
        return false;
    }
    last_name_ = page_.last ? "\x7f" : page_.behind;  // 7f: behind every name
    if (!pages_.empty() && pages_.back().second == log_->last())
        pages_.back().first = last_name_;
    else
        pages_.emplace_back(last_name_, log_->last());
    return true;
}

bool ChangeFeed::bookmark(StreamEvent& event, const Instant& now) {
    bookmark_due_ = false;
    if (placed_ == sent_) return false;
    placed_ = sent_;
    quiet_since_ = now.time;
    event = {"bookmark", Place{log_->epoch(), sent_}.text(), "{}"};
    return true;
}

bool ChangeFeed::next_change(StreamEvent& event, const Instant& now) {
    while (const auto* change = log_->change(sent_ + 1)) {
        if (placed_ == sent_) quiet_since_ = now.time;
        ++sent_;
        if (!matches(*change) || in_snapshot(*change)) {
            if (sent_ - placed_ >= kBookmarkAfter) return bookmark(event, now);
            continue;
        }
        placed_ = sent_;
        event = {change->kind, Place{log_->epoch(), sent_}.text(), change->data};
        return true;
    }
    if (!pages_.empty() && log_->last() >= pages_.back().second) pages_.clear();
    return bookmark_due_ && bookmark(event, now);
}

}  // namespace asip::gateway
