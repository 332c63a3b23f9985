// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/requester.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/bus/json/json_scanner.hpp"
#include "asip/bus/request/request_envelope.hpp"
#include "asip/model/json.hpp"

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

}  // namespace

const std::string& Requester::Request::id() const {
    static const std::string none;
    return entry_ ? entry_->id : none;
}

Requester::Request Requester::ask(mqtt::Message& message, bool v5, OnReply on_reply, Time now,
                                  const More& more) {
    std::erase_if(open_, [](const auto& one) { return one.second.expired(); });
    const auto id = name_ + "-" + std::to_string(++last_);
    const auto entry = std::make_shared<Request::Entry>(
        Request::Entry{id, replies_.to(message.topic), std::move(on_reply), {}});
    open_.emplace(id, entry);
    std::optional<std::string> clock;
    if (is_command_topic(message.topic)) {
        entry->asked = now;
        clock = clocks_.reading(entry->reply_topic, now);
    }
    if (v5) {
        message.response_topic = entry->reply_topic;
        message.correlation = id;
        if (clock) message.user_properties.emplace_back(kClockName, *clock);
    }
    if (!v5 || !more.plain)
        message.payload = with_reply_members(message.payload, entry->reply_topic, id, clock, more.deadline);
    return Request(entry);
}

bool Requester::take(const mqtt::Message& message, Time now) {
    if (!replies_.have(message.topic)) return false;
    const auto found =
        open_.find(message.correlation.empty() ? member_of(message.payload, "id") : message.correlation);
    if (found == open_.end()) return true;
    const auto entry = found->second.lock();
    if (!entry || entry->reply_topic != message.topic) return true;
    if (entry->asked) clocks_.note(entry->reply_topic, clock_in(message), *entry->asked, now);
    entry->on_reply(message);
    return true;
}

std::string with_reply_members(const std::string& payload, const std::string& reply_to, const std::string& id,
                               const std::optional<std::string>& clock,
                               std::optional<std::chrono::milliseconds> deadline) {
    auto document = model::parse_json(payload, {.max_bytes = 1u << 20, .max_depth = 32});
    nlohmann::json object = nlohmann::json::object();
    if (document && document->is_object()) {
        object = std::move(*document);
    } else {
        object["raw"] = payload;
    }
    object["reply_to"] = reply_to;
    object["id"] = id;
    if (clock) object[std::string(kClockName)] = *clock;
    if (deadline && !object.contains("deadline_ms"))
        object["deadline_ms"] = std::clamp(*deadline, kMinDeadline, kMaxDeadline).count();
    return model::dump_json(object);
}

bool is_command_topic(std::string_view topic) {
    return topic.ends_with("/in");
}

std::string clock_in(const mqtt::Message& answer) {
    for (const auto& [name, value] : answer.user_properties)
        if (name == kClockName) return value;
    return answer.correlation.empty() ? member_of(answer.payload, kClockName) : std::string();
}

}  // namespace asip::bus
