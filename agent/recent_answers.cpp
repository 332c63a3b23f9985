// SPDX-License-Identifier: Apache-2.0
#include "agent/recent_answers.hpp"

#include <functional>
#include <string>

namespace asip::agent {

namespace {

std::size_t bytes_of(const bus::Reply& reply) {
    return sizeof reply + reply.proof.capacity() + reply.answer.capacity() + reply.error.capacity() +
           reply.reason.capacity();
}

}  // namespace

RecentAnswers::Key RecentAnswers::key(std::string_view topic, std::string_view reply_topic,
                                      std::string_view id) {
    std::string all(topic);
    for (const auto part : {reply_topic, id}) {
        all += '\0';
        all += part;
    }
    return std::hash<std::string>{}(all);
}

std::size_t RecentAnswers::bytes() const {
    return entries_.size() * kEntryBytes + reply_bytes_;
}

RecentAnswers::Seen RecentAnswers::see(Key key, std::string_view payload, Time now) {
    forget_old(now);
    const std::uint64_t hash = std::hash<std::string_view>{}(payload);
    const auto [known, is_new] = entries_.try_emplace(key);
    Entry& entry = known->second;
    if (!is_new) {
        if (entry.payload != hash) return Seen::kOtherPayload;
        return entry.answered ? Seen::kAnswered : Seen::kPending;
    }
    entry.payload = hash;
    entry.number = next_number_++;
    turns_.push_back({now, key, entry.number});
    return Seen::kNew;
}

void RecentAnswers::answer(Key key, const bus::Reply& reply) {
    const auto known = entries_.find(key);
    if (known == entries_.end()) return;
    Entry& entry = known->second;
    entry.answered = true;
    if (reply == bus::Reply::ok("fence")) return;
    entry.reply = std::make_unique<bus::Reply>(reply);
    entry.reply->id.clear();
    reply_bytes_ += bytes_of(*entry.reply);
    forget_old(std::nullopt);
}

std::unique_ptr<bus::Reply> RecentAnswers::find(Key key) const {
    const auto known = entries_.find(key);
    if (known == entries_.end() || !known->second.answered) return nullptr;
    const auto& reply = known->second.reply;
    return std::make_unique<bus::Reply>(reply ? *reply : bus::Reply::ok("fence"));
}

void RecentAnswers::erase(Key key) {
    const auto known = entries_.find(key);
    if (known->second.reply) reply_bytes_ -= bytes_of(*known->second.reply);
    entries_.erase(known);
}

void RecentAnswers::forget(Key key) {
    if (entries_.contains(key)) erase(key);
}

void RecentAnswers::forget_old(std::optional<Time> now) {
    while (!turns_.empty()) {
        const Turn oldest = turns_.front();
        const auto known = entries_.find(oldest.key);
        const bool there = known != entries_.end() && known->second.number == oldest.number;
        const bool expired = now && oldest.seen + kKept < *now;
        const bool too_many = bytes() + kEntryBytes > kMaxBytes || turns_.size() > 2 * kGuaranteed;
        if (there && !expired && !too_many) return;
        if (there && !expired) ++dropped_;
        if (there) erase(oldest.key);
        turns_.pop_front();
    }
}

}  // namespace asip::agent
