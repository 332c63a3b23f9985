// SPDX-License-Identifier: Apache-2.0
#include "gateway/commands/commands.hpp"

#include <utility>

#include "asip/bus/request/reply.hpp"

namespace asip::gateway {
namespace {

bool was_refused(const CommandRecord& record) {
    return record.reply && record.reply->status == bus::Reply::Status::kRefused;
}

}  // namespace

std::size_t Commands::bytes_of(const Start& start) {
    // With its key, its topics and its waiters, and what the caller has of it.
    constexpr std::size_t kBytesOfRecord = sizeof(Entry) + 768;
    return kBytesOfRecord + start.payload.capacity() + start.target.capacity() + start.by.capacity();
}

std::string Commands::bus_id(std::string_view session, std::string_view id) {
    return std::string(session).append(".").append(id);
}

Commands::Started Commands::start(Start& start, const Instant& now, Done done) {
    if (start.id.empty()) start.id = "auto-" + std::to_string(++made_up_);
    auto key = bus_id(start.session, start.id);
    auto found = entries_.find(key);
    if (found != entries_.end() && was_refused(found->second.record)) {
        if (before_again) before_again();
        kept_.erase(found->second.kept);
        entries_.erase(found);
        found = entries_.end();
    }
    if (found != entries_.end()) {
        auto& entry = found->second;
        if (entry.topic != start.topic || entry.record.request != start.payload) return Started::kIdReused;
        if (entry.record.reply)
            done(entry.record);
        else
            entry.waiting.push_back(std::move(done));
        return Started::kRepeated;
    }
    if (entries_.size() >= kMaxRecords + (start.urgent ? kMaxUrgent : 0)) return Started::kTooMany;
    caller::Command command{.topic = start.topic, .payload = start.payload, .deadline = start.deadline};
    command.lasts = command.first = start.urgent;  // a stop is never too late
    command.late = true;
    command.by = start.by;
    command.id = key;
    command.replies =
        (start.answer_first ? caller_.replies().urgent() : caller_.replies()).below(start.session);
    Entry entry{{start.id,
                 start.by,
                 start.target,
                 std::move(start.payload),
                 now,
                 {},
                 false,
                 start.renewal,
                 start.of_many},
                std::move(start.topic),
                std::move(start.part)};
    entry.waiting.push_back(std::move(done));
    found = entries_.emplace(std::move(key), std::move(entry)).first;
    found->second.call = caller_.command(
        std::move(command), [this, found](const bus::Reply& reply) { finish(found, reply); }, now.time);
    return Started::kSent;
}

void Commands::finish(Entries::iterator found, bus::Reply reply) {
    using Status = bus::Reply::Status;
    auto& [key, entry] = *found;
    auto& record = entry.record;
    record.late = record.reply.has_value();
    reply.clock.clear();
    reply.id = record.id;
    reply.by = record.by;
    if (record.late) {
        kept_.erase(entry.kept);
    } else {
        ++(reply.status == Status::kOk        ? counters_.ok
           : reply.status == Status::kError   ? counters_.error
           : reply.status == Status::kTimeout ? counters_.timeout
                                              : counters_.refused);
    }
    entry.kept = kept_.emplace(caller_.now() + kKeep, key);
    // What does not fit is no use to anybody: the command is what it is by its status.
    if (reply.answer.size() > kMaxAnswerBytes || !entry.part.add(reply.answer.size() + reply.error.size())) {
        reply.answer.clear();
        reply.reason = "answer-too-long";
    }
    record.reply = std::move(reply);
    // Entries stay where they are, whatever `done` begins.
    for (const auto& done : std::exchange(entry.waiting, {}))
        done(record);
    if (on_finished) on_finished(record, caller_.now() - record.sent.time);  // behind the answers: it logs
}

void Commands::tick(Time now) {
    while (!kept_.empty() && kept_.begin()->first <= now) {
        entries_.erase(entries_.find(kept_.begin()->second));
        kept_.erase(kept_.begin());
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
