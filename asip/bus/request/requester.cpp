// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/requester.hpp"

#include <algorithm>

#include "asip/bus/json/json_scanner.hpp"
#include "asip/bus/json/json_text.hpp"
#include "asip/bus/request/request_envelope.hpp"

namespace asip::bus {
namespace {

/// A member of an answer. Answers may be megabytes: they are not parsed for it.
std::string member_of(std::string_view payload, std::string_view name) {
    JsonScanner scanner(payload);
    if (!scanner.enter_object()) return {};
    std::string_view key;
    while (scanner.next_member(key)) {
        std::string_view value;
        if (key == name && scanner.plain_string(value)) return std::string(value);
        if (!scanner.value(value)) return {};
    }
    return {};
}

constexpr std::size_t kOftenSwept = 16;

struct Members {
    std::string text;  // each with a comma before it
    bool has_deadline = false;
    bool has_by = false;
};

/// The members of a JSON object as they are written, but for those that the asker gives a request. Nothing:
/// the payload is no object. Building a tree of them would cost more than all the rest of a request.
std::optional<Members> members_of(std::string_view payload, bool clock) {
    JsonScanner scanner(payload);
    if (!scanner.enter_object()) return std::nullopt;
    Members members;
    std::string_view key, value;
    while (scanner.next_member(key)) {
        const bool is_of_asker = key == "reply_to" || key == "id" || (clock && key == kClockName);
        members.has_deadline = members.has_deadline || key == "deadline_ms";
        members.has_by = members.has_by || key == "by";
        const auto name = scanner.raw_key();
        if (!scanner.value(value)) return std::nullopt;
        if (!is_of_asker) ((members.text += ",\"").append(name) += "\":").append(value);
    }
    if (!scanner.left() || !scanner.at_end()) return std::nullopt;
    return members;
}

/// Whether an agent executes what comes on this topic, and tells its clock with the answer.
bool is_command_topic(std::string_view topic) {
    return topic.ends_with("/in");
}

/// A user property, or a member of the answer's JSON; empty: none.
std::string clock_in(const mqtt::Message& answer) {
    for (const auto& [name, value] : answer.user_properties)
        if (name == kClockName) return value;
    return answer.correlation.empty() ? member_of(answer.payload, kClockName) : std::string();
}

// Where the answer goes stands first: a reader of what is too long or broken finds it. An empty clock asks
// for one.
std::string with_reply_members(const std::string& payload, const std::string& reply_to, const std::string& id,
                               const std::optional<std::string>& clock, const Requester::More& more) {
    constexpr std::size_t kAround = 128;
    std::string out;
    out.reserve(kAround + payload.size() + reply_to.size() + id.size() + more.by.size());
    out += '{';
    const auto text = [&out](std::string_view name, std::string_view value) {
        (out += out.size() > 1 ? ",\"" : "\"").append(name) += "\":";
        append_json_text(out, value);
    };
    if (clock) text(kClockName, *clock);
    text("id", id);
    text("reply_to", reply_to);
    const auto members = members_of(payload, clock.has_value());
    if (more.deadline && !(members && members->has_deadline)) {
        const auto ms = std::clamp(*more.deadline, kMinDeadline, kMaxDeadline).count();
        out.append(",\"deadline_ms\":").append(std::to_string(ms));
    }
    if (!more.by.empty() && !(members && members->has_by)) text("by", more.by);
    if (members)
        out += members->text;
    else
        text("raw", payload);
    return out += '}';
}

}  // namespace

const std::string& Requester::Request::id() const {
    static const std::string none;
    return entry_ ? entry_->id : none;
}

Requester::Request Requester::ask(mqtt::Message& message, bool v5, OnReply on_reply, Time now,
                                  const More& more) {
    if (open_.size() >= sweep_at_) {
        std::erase_if(open_, [](const auto& one) { return one.second.expired(); });
        sweep_at_ = 2 * open_.size() + kOftenSwept;
    }
    const auto& replies = more.replies == nullptr ? replies_ : *more.replies;
    const auto entry = std::make_shared<Request::Entry>(
        Request::Entry{more.id.empty() ? name_ + "-" + std::to_string(++last_) : more.id,
                       replies.to(message.topic),
                       std::move(on_reply),
                       {},
                       now});
    open_.insert_or_assign(entry->id, entry);
    std::optional<std::string> clock;
    if (is_command_topic(message.topic)) {
        entry->clock_of = replies_.asked(message.topic);
        clock = clocks_.reading(entry->clock_of, now);
    }
    if (v5) {
        message.response_topic = entry->reply_topic;
        message.correlation = entry->id;
        if (clock) message.user_properties.emplace_back(kClockName, *clock);
    }
    if (!v5 || !more.plain)
        message.payload = with_reply_members(message.payload, entry->reply_topic, entry->id, clock, more);
    return Request(entry);
}

bool Requester::take(const mqtt::Message& message, Time now) {
    if (!replies_.of_user(message.topic)) return false;
    const auto found =
        open_.find(message.correlation.empty() ? member_of(message.payload, "id") : message.correlation);
    const auto entry = found == open_.end() ? nullptr : found->second.lock();
    if (!entry || entry->reply_topic != message.topic) return replies_.have(message.topic);
    if (!entry->clock_of.empty()) clocks_.note(entry->clock_of, clock_in(message), entry->asked, now);
    entry->on_reply(message);
    return true;
}

}  // namespace asip::bus
