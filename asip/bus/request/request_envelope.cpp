// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/request_envelope.hpp"

#include <algorithm>
#include <utility>

#include "asip/bus/json/written_numbers.hpp"
#include "asip/bus/request/agent_clock.hpp"
#include "asip/bus/request/broken_request.hpp"
#include "asip/model/json.hpp"
#include "asip/mqtt/client_core.hpp"
#include "asip/text/file_text.hpp"

namespace asip::bus {
namespace {

using nlohmann::json;

bool valid_reply_topic(std::string_view topic) {
    if (topic.empty() || topic.size() > kMaxReplyTopicBytes || topic.front() == '$') return false;
    const bool controls = std::any_of(topic.begin(), topic.end(), [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return byte < 0x20 || byte == 0x7f;
    });
    return !controls && mqtt::can_be_topic(std::string(topic));
}

bool looks_like_json(std::string_view payload) {
    const auto first = payload.find_first_not_of(" \t\r\n");
    return first != std::string_view::npos && payload[first] == '{';
}

Unexpected<BadRequest> bad(ReplyTo reply, std::string error) {
    return Unexpected<BadRequest>(BadRequest{std::move(reply), std::move(error)});
}

// At the end of a character of UTF-8.
std::string cut_name(std::string name) {
    if (name.size() <= kMaxByBytes) return name;
    auto end = kMaxByBytes;
    while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0) == 0x80)
        --end;
    name.resize(end);
    return name;
}

void read_properties(const mqtt::Message& request, RequestEnvelope& envelope) {
    for (const auto& [name, value] : request.user_properties) {
        if (name == "by" && envelope.reply.by.empty()) envelope.reply.by = cut_name(value);
        if (name == kClockName) envelope.sent = value, envelope.reply.clock = true;
    }
}

/// The reason when it cannot be used.
std::string take_clock(json& object, RequestEnvelope& envelope) {
    const auto clock = object.find(kClockName);
    if (clock == object.end()) return {};
    if (!clock->is_string()) return "\"clock\" must be a string";
    if (!std::exchange(envelope.reply.clock, true)) envelope.sent = clock->get<std::string>();
    object.erase(clock);
    return {};
}

/// Moves `reply_to`, `id` and `by` out of the object; the reason when they cannot be used.
std::string take_reply_members(json& object, ReplyTo& reply) {
    if (const auto topic = object.find("reply_to"); topic != object.end()) {
        if (!topic->is_string() || !valid_reply_topic(topic->get_ref<const std::string&>())) {
            return "\"reply_to\" is not a topic to publish on";
        }
        if (!reply.wanted()) reply.topic = topic->get<std::string>();
        object.erase(topic);
    }
    if (const auto by = object.find("by"); by != object.end() && by->is_string()) {
        if (reply.by.empty()) reply.by = cut_name(by->get<std::string>());
        object.erase(by);
    }
    if (const auto id = object.find("id"); id != object.end()) {
        if (!id->is_string() && !id->is_number()) return "\"id\" must be a string or a number";
        auto text = id->is_string() ? id->get<std::string>() : id->dump();
        if (text.size() > kMaxRequestIdBytes) return "\"id\" is too long";
        reply.id = std::move(text);
        object.erase(id);
    }
    return {};
}

}  // namespace

std::string RequestEnvelope::shown() const {
    return form == Form::kRaw ? text : model::dump_json(object);
}

Expected<RequestEnvelope, BadRequest> open_envelope(const mqtt::Message& request) {
    RequestEnvelope envelope;
    const std::string_view payload = text::without_mark(request.payload);
    read_properties(request, envelope);
    if (!request.response_topic.empty()) {
        if (!valid_reply_topic(request.response_topic))
            return bad(std::move(envelope.reply), "the response topic cannot be published on");
        envelope.reply.topic = request.response_topic;
        envelope.reply.properties = true;
        if (request.correlation.size() > kMaxCorrelationBytes)
            return bad(std::move(envelope.reply), "the correlation data is too long");
        envelope.reply.correlation = request.correlation;
    }
    const bool is_json = looks_like_json(payload);
    const auto unreadable = [&](std::string why) {
        BrokenRequest broken;
        if (is_json) broken = read_broken_request(std::string(payload.substr(0, kMaxRequestBytes)));
        take_reply_members(broken.members, envelope.reply);
        return bad(std::move(envelope.reply), why.empty() ? std::move(broken.error) : std::move(why));
    };
    if (request.payload.size() > kMaxRequestBytes)
        return unreadable("the request is longer than " + std::to_string(kMaxRequestBytes) + " bytes");
    if (!is_json) {
        envelope.text = payload;
        return envelope;
    }
    if (!model::json_depth_within(payload, kMaxJsonDepth)) return unreadable("the JSON is nested too deeply");
    auto object = json::parse(payload, nullptr, false);
    if (!object.is_object()) return unreadable({});
    keep_numbers(payload, object, {"id", "renew"});
    if (auto reason = take_reply_members(object, envelope.reply); !reason.empty()) {
        return bad(std::move(envelope.reply), std::move(reason));
    }
    if (auto reason = take_clock(object, envelope); !reason.empty())
        return bad(std::move(envelope.reply), std::move(reason));
    for (const auto& [name, value] :
         {std::pair("deadline_ms", &envelope.deadline), std::pair("hold_ms", &envelope.hold)}) {
        static_assert(kMinDeadline == kMinHold && kMaxDeadline == kMaxHold);
        const auto member = object.find(name);
        if (member == object.end()) continue;
        const auto ms = member->is_number_integer() ? member->get<std::int64_t>() : 0;
        if (ms < kMinDeadline.count() || ms > kMaxDeadline.count())
            return bad(std::move(envelope.reply),
                       "\"" + std::string(name) + "\" must be a whole number from 50 to 60000");
        *value = std::chrono::milliseconds(ms);
        object.erase(member);
    }
    if (const auto raw = object.find("raw"); raw != object.end()) {
        if (!raw->is_string()) return bad(std::move(envelope.reply), "\"raw\" must be a string");
        envelope.text = raw->get<std::string>();
        return envelope;
    }
    envelope.form = RequestEnvelope::Form::kJson;
    envelope.object = std::move(object);
    return envelope;
}

}  // namespace asip::bus
