// SPDX-License-Identifier: Apache-2.0
#include "agent/command/recent_answers.hpp"

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

RecentAnswers::Seen RecentAnswers::see(Key key, std::string_view payload, Time now,
                                       std::optional<Time> sent) {
    forget_old(now);
    const std::uint64_t hash = std::hash<std::string_view>{}(payload);
    if (const auto known = entries_.find(key); known != entries_.end()) {
        const Entry& entry = known->second;
        if (!entry.refused()) {
            if (entry.payload != hash) return Seen::kOtherPayload;
            return entry.answered ? Seen::kAnswered : Seen::kPending;
        }
        if (sent && sent <= entry.sent) return Seen::kAnswered;
        erase(key);
    }
    const std::uint32_t number = next_number_++;
    entries_[key] = {.payload = hash, .sent = sent, .number = number, .reply = {}};
    turns_.push_back({now, key, number});
    return Seen::kNew;
}

void RecentAnswers::answer(Key key, const bus::Reply& reply) {
    const auto known = entries_.find(key);
    if (known == entries_.end()) return;
    Entry& entry = known->second;
    if (reply.status == bus::Reply::Status::kRefused) {
        if (!entry.sent) return erase(key);
        auto& refusal = refusals_[reply.reason];
        if (!refusal)
            refusal = std::make_shared<bus::Reply>(
                bus::Reply::refused(reply.reason, "a copy of a message that was refused"));
        entry.answered = true;
        entry.reply = refusal;
        return;
    }
    entry.answered = true;
    if (reply == bus::Reply::ok("fence")) return;
    auto kept = std::make_shared<bus::Reply>(reply);
    kept->id.clear();
    reply_bytes_ += bytes_of(*kept);
    entry.reply = std::move(kept);
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
    const Entry& entry = known->second;
    if (entry.reply && !entry.refused()) reply_bytes_ -= bytes_of(*entry.reply);
    entries_.erase(known);
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
