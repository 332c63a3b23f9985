// SPDX-License-Identifier: Apache-2.0
#include "gateway/commands/commands.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "asip/bus/request/answer_words.hpp"
#include "asip/bus/request/requester.hpp"
#include "asip/model/json.hpp"

namespace asip::gateway {
namespace {

std::string with_deadline(std::string payload, Duration deadline) {
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(deadline).count();
    payload.pop_back();
    return payload + (payload.size() > 1 ? "," : "") + "\"deadline_ms\":" + std::to_string(ms) + "}";
}

// MQTT 3.1.1 has no user properties, nor has a bridge that speaks it.
std::string with_by(std::string payload, const std::string& by) {
    if (by.empty()) return payload;
    payload.pop_back();
    return payload + (payload.size() > 1 ? "," : "") + "\"by\":" + model::dump_json(nlohmann::json(by)) + "}";
}

bool was_refused(const CommandRecord& record) {
    return record.reply && record.reply->status == bus::Reply::Status::kRefused;
}

}  // namespace

std::size_t Commands::bytes_of(const Start& start) {
    constexpr std::size_t kBytesOfRecord = sizeof(Entry) + 512;  // with its key, its topics and its waiters
    return kBytesOfRecord + start.payload.capacity() + start.target.capacity() + start.by.capacity();
}

std::string Commands::bus_id(std::string_view session, std::string_view id) {
    return std::string(session).append(".").append(id);
}

void Commands::forget(Entries::iterator entry) {
    if (before_again) before_again();
    due_.erase(entry->second.due);
    entries_.erase(entry);
}

Commands::Started Commands::start(Start& start, bool v5, const Instant& now, Done done,
                                  mqtt::Message& message) {
    if (start.id.empty()) start.id = "auto-" + std::to_string(++made_up_);
    const auto key = bus_id(start.session, start.id);
    auto found = entries_.find(key);
    if (found != entries_.end() && was_refused(found->second.record)) {
        forget(found);
        found = entries_.end();
    }
    if (found != entries_.end()) {
        auto& entry = found->second;
        if (entry.topic != start.topic || entry.record.request != start.payload) return Started::kIdReused;
        if (entry.answered)
            done(entry.record);
        else
            entry.waiting.push_back(std::move(done));
        return Started::kRepeated;
    }
    if (entries_.size() >= kMaxRecords + (start.urgent ? kMaxUrgent : 0)) return Started::kTooMany;
    message.topic = start.topic;
    message.qos = 1;
    message.payload = with_deadline(start.payload, start.deadline);
    const auto reply_topic =
        (start.answer_first ? urgent(replies_) : replies_).below(start.session).to(start.topic);
    if (!start.by.empty()) message.user_properties = {{"by", start.by}};
    std::optional<std::string> clock;
    if (bus::is_command_topic(start.topic)) clock = clocks_.reading(replies_.to(start.topic), now.time);
    if (v5) {
        message.response_topic = reply_topic;
        message.correlation = key;
        if (clock) message.user_properties.emplace_back(bus::kClockName, *clock);
    }
    message.payload = bus::with_reply_members(with_by(message.payload, start.by), reply_topic, key, clock);
    // A stop is never too late.
    if (!start.urgent) message.expire_after(start.deadline);
    Entry entry;
    entry.record = {start.id,     start.by, start.target,  start.payload, now,
                    std::nullopt, false,    start.renewal, start.of_many};
    entry.part = std::move(start.part);
    entry.topic = start.topic;
    entry.reply_topic = reply_topic;
    entry.waiting.push_back(std::move(done));
    const auto added = entries_.emplace(key, std::move(entry)).first;
    added->second.due = due_.emplace(now.time + start.deadline + kGrace, added->first);
    return Started::kPublish;
}

void Commands::not_published(const Start& start, const Instant& now) {
    const auto found = entries_.find(bus_id(start.session, start.id));
    if (found == entries_.end() || found->second.answered) return;
    finish(found->second,
           bus::Reply::refused(std::string(bus::kRefusedQueueFull),
                               "the broker takes commands more slowly than they come: this one was not sent"),
           now.time);
}

bool Commands::take(const mqtt::Message& message, const Instant& now) {
    if (!replies_.of_user(message.topic)) return false;
    auto reply = bus::parse_reply(message.payload);
    if (!reply) return false;
    const auto found = entries_.find(message.correlation.empty() ? reply->id : message.correlation);
    if (found == entries_.end() || found->second.reply_topic != message.topic) return false;
    auto& entry = found->second;
    if (bus::is_command_topic(entry.topic))
        clocks_.note(replies_.to(entry.topic), bus::clock_in(message), entry.record.sent.time, now.time);
    reply->clock.clear();
    if (entry.answered && (!entry.record.reply || entry.record.reply->reason != bus::kTimeoutNoAnswer))
        return true;
    finish(entry, std::move(*reply), now.time);
    return true;
}

void Commands::finish(Entry& entry, bus::Reply reply, Time now) {
    using Status = bus::Reply::Status;
    reply.id = entry.record.id;
    reply.by = entry.record.by;
    entry.record.late = entry.answered;
    const auto key = entry.due->second;
    due_.erase(entry.due);
    entry.due = due_.emplace(now + kKeep, key);
    auto& counter = reply.status == Status::kOk        ? counters_.ok
                    : reply.status == Status::kError   ? counters_.error
                    : reply.status == Status::kTimeout ? counters_.timeout
                                                       : counters_.refused;
    if (!entry.answered) ++counter;
    entry.record.reply = std::move(reply);
    entry.answered = true;
    // What does not fit is no use to anybody: the command is what it is by its status.
    auto& answer = entry.record.reply->answer;
    if (answer.size() > kMaxAnswerBytes ||
        !entry.part.add(answer.size() + entry.record.reply->error.size())) {
        answer.clear();
        entry.record.reply->reason = "answer-too-long";
    }
    const auto& record = entry.record;  // entries stay where they are, whatever `done` begins
    for (const auto& done : std::exchange(entry.waiting, {}))
        done(record);
    if (on_finished) on_finished(record, now - record.sent.time);  // behind the answers: it logs
}

void Commands::tick(const Instant& now) {
    while (!due_.empty() && due_.begin()->first <= now.time) {
        const auto found = entries_.find(due_.begin()->second);
        if (!found->second.answered) {
            finish(found->second, bus::Reply::timeout(bus::kTimeoutNoAnswer), now.time);
            continue;
        }
        due_.erase(due_.begin());
        entries_.erase(found);
    }
}

void Commands::leave(const Instant& now) {
    for (auto& [key, entry] : entries_) {
        if (entry.answered) continue;
        auto reply = bus::Reply::timeout(bus::kTimeoutNoAnswer);
        reply.error = "the gateway ended before the answer";
        finish(entry, std::move(reply), now.time);
    }
}

const CommandRecord* Commands::find(std::string_view session, std::string_view id) const {
    const auto found = entries_.find(bus_id(session, id));
    return found == entries_.end() ? nullptr : &found->second.record;
}

std::string Commands::topic_of(std::string_view session, std::string_view id) const {
    const auto found = entries_.find(bus_id(session, id));
    return found == entries_.end() ? std::string() : found->second.topic;
}

std::string text_for_clients(bus::Reply reply) {
    if (!reply.succeeded()) reply.error = bus::why_of(reply);
    return bus::to_json_text(reply);
}

int http_status(const bus::Reply& reply) {
    switch (reply.status) {
        case bus::Reply::Status::kOk:
            return 200;
        case bus::Reply::Status::kError:
            return 422;
        case bus::Reply::Status::kTimeout:
            return 504;
        case bus::Reply::Status::kRefused:
            break;
    }
    if (reply.reason == bus::kRefusedQueueFull) return 429;
    if (reply.reason == bus::kRefusedBoardNotThere || reply.reason == bus::kRefusedDeadline) return 503;
    if (reply.reason == bus::kRefusedInvalid || reply.reason == bus::kRefusedRetained) return 400;
    return 409;  // id-reused, stopped, ...: it contradicts what was done before
}

}  // namespace asip::gateway
