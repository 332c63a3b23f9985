// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/request_envelope.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "asip/bus/json/json_text.hpp"
#include "asip/bus/request/agent_clock.hpp"
#include "asip/model/json.hpp"
#include "asip/mqtt/client_core.hpp"
#include "asip/text/file_text.hpp"

namespace asip::bus {

namespace {

using nlohmann::json;

constexpr std::string_view kServiceBus = "servicebus/";
constexpr std::string_view kUrgent = "-urgent";

bool can_be_level(std::string_view text) {
    return !text.empty() && std::none_of(text.begin(), text.end(), [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return byte < 0x20 || byte == 0x7f || c == '+' || c == '#' || c == '/';
    });
}

constexpr int kMaxNumbers = 8;        // the text is read anew after each
constexpr int kNumberTooLarge = 406;  // of the library's exceptions

/// Notes the members that say where an answer goes, up to the first fault.
class ReplyMembers final : public json::json_sax_t {
  public:
    json members = json::object();
    bool number_too_large = false;
    std::size_t fault_end = 0;  ///< of the token at which it stopped
    std::size_t fault_bytes = 0;

    bool null() override { return true; }
    bool boolean(bool) override { return true; }
    bool number_integer(json::number_integer_t value) override { return note(value); }
    bool number_unsigned(json::number_unsigned_t value) override { return note(value); }
    bool number_float(json::number_float_t value, const std::string&) override { return note(value); }
    bool string(std::string& value) override { return note(std::move(value)); }
    bool binary(json::binary_t&) override { return true; }
    bool start_object(std::size_t) override { return ++depth_, true; }
    bool end_object() override { return --depth_, true; }
    bool start_array(std::size_t) override { return ++depth_, true; }
    bool end_array() override { return --depth_, true; }
    bool key(std::string& name) override {
        if (depth_ == 1) key_ = name;
        return true;
    }
    bool parse_error(std::size_t position, const std::string& token, const json::exception& fault) override {
        number_too_large = fault.id == kNumberTooLarge;
        fault_end = position;
        fault_bytes = token.size();
        return false;
    }

  private:
    template <class Value>
    bool note(Value&& value) {
        constexpr std::array<std::string_view, 3> kWanted{"reply_to", "id", "by"};
        if (depth_ == 1 && std::find(kWanted.begin(), kWanted.end(), key_) != kWanted.end())
            members[key_] = std::forward<Value>(value);
        return true;
    }
    int depth_ = 0;
    std::string key_;
};

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
        if (!topic->is_string() || !valid_reply_topic(topic->get_ref<const std::string&>()))
            return "\"reply_to\" is not a topic to publish on";
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

std::string asker_of(const std::string& topic) {
    constexpr std::string_view kReply = "/reply/";
    const auto begin = topic.find(kReply);
    if (begin == std::string::npos) return topic;
    const auto user =
        topic.substr(begin + kReply.size(), topic.find('/', begin + kReply.size()) - begin - kReply.size());
    return user.starts_with('$') ? topic : user;
}

std::string user_level(std::string_view user) {
    return std::string(can_be_level(user) ? user : "$nobody");
}

ReplyTopics::ReplyTopics(const Topics& topics, std::string_view user, std::string_view client)
    : root_(topics.root() + "/"),
      prefix_(root_ + "reply/" + user_level(user) + "/"),
      client_("/" + std::string(client)) {}

ReplyTopics ReplyTopics::below(std::string_view level) const {
    ReplyTopics made = *this;
    made.client_.append("/").append(level);
    return made;
}

ReplyTopics ReplyTopics::urgent() const {
    ReplyTopics made = *this;
    made.client_.append(kUrgent);
    return made;
}

std::string ReplyTopics::without_urgent(std::string topic) {
    const auto at = topic.find(kUrgent);
    const auto end = at == std::string::npos ? at : at + kUrgent.size();
    if (end == topic.size() || (end < topic.size() && topic[end] == '/')) topic.erase(at, kUrgent.size());
    return topic;
}

std::string_view ReplyTopics::asked(std::string_view request_topic) const {
    if (request_topic.starts_with(root_)) request_topic.remove_prefix(root_.size());
    // A demand stands on the service bus, and the board answers it.
    if (request_topic.starts_with(kServiceBus)) request_topic.remove_prefix(kServiceBus.size());
    return request_topic.substr(0, request_topic.find('/'));
}

bool ReplyTopics::have(std::string_view topic) const {
    if (!of_user(topic)) return false;
    topic.remove_prefix(prefix_.size());
    const auto level = topic.find('/');
    return level != std::string_view::npos && topic.substr(level) == client_;
}

std::string ReplyTopics::of(std::string_view asked) const {
    return std::string(prefix_).append(asked).append(client_);
}

bool may_answer_on(std::string_view topic, const Topics& topics, std::string_view answerer) {
    const auto below = topics.root() + "/reply/";
    if (!topic.starts_with(below)) return false;
    topic.remove_prefix(below.size());
    const auto user = topic.find('/');
    if (user == 0 || user == std::string_view::npos) return false;
    topic.remove_prefix(user + 1);
    return topic.size() > answerer.size() + 1 && topic.starts_with(answerer) && topic[answerer.size()] == '/';
}

namespace {

/// A request that is no JSON, so that its sender gets the refusal.
struct BrokenRequest {
    /// Those of `reply_to`, `id` and `by` that stand before the fault.
    nlohmann::json members = nlohmann::json::object();
    std::string error;  ///< a sentence for a person
};

/// An impossible number (`1e400`) does not end the reading.
BrokenRequest read_broken_request(std::string text) {
    constexpr std::string_view kNothing = "null";
    std::string error = "the request is not valid JSON";
    for (int number = 0;; ++number) {
        ReplyMembers reader;
        const bool whole = json::sax_parse(text, &reader);
        const bool goes_on = reader.number_too_large && number < kMaxNumbers &&
                             reader.fault_bytes >= kNothing.size() &&
                             reader.fault_bytes <= reader.fault_end && reader.fault_end <= text.size();
        if (whole || !goes_on) return {std::move(reader.members), std::move(error)};
        error = "a number in the request is too large";
        const auto start = reader.fault_end - reader.fault_bytes;
        std::fill_n(text.begin() + static_cast<std::ptrdiff_t>(start), reader.fault_bytes, ' ');
        text.replace(start, kNothing.size(), kNothing);
    }
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
    if (auto reason = take_reply_members(object, envelope.reply); !reason.empty())
        return bad(std::move(envelope.reply), std::move(reason));
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
