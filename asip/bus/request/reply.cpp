// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/reply.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "asip/bus/json/json_scanner.hpp"
#include "asip/bus/json/json_text.hpp"
#include "asip/bus/request/agent_clock.hpp"
#include "asip/bus/request/agent_requests.hpp"
#include "asip/bus/request/request_envelope.hpp"
#include "asip/model/json.hpp"

namespace asip::bus {

namespace {

using nlohmann::json;
using S = Reply::Status;

std::optional<Reply::Status> status_named(std::string_view name) {
    using Status = Reply::Status;
    for (const auto status : {Status::kOk, Status::kError, Status::kTimeout, Status::kRefused})
        if (name == to_string(status)) return status;
    return std::nullopt;
}

std::string text_member(const json& object, const char* name) {
    const auto member = object.find(name);
    if (member == object.end()) return {};
    if (member->is_string()) return member->get<std::string>();
    return member->is_number() ? member->dump() : std::string{};
}

std::string dump(const json& value) {
    return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

// What is no JSON becomes a JSON string.
std::string answer_text(const std::string& answer) {
    auto value = model::json_depth_within(answer, kMaxJsonDepth) ? json::parse(answer, nullptr, false)
                                                                 : json(json::value_t::discarded);
    return dump(value.is_discarded() ? json(answer) : value);
}

/// A reply of nothing but short words, as most are: a tree of values costs several times as much. Nothing: it
/// is another one, or none.
std::optional<Reply> plain_reply(std::string_view text) {
    JsonScanner scanner(text);
    if (!scanner.enter_object()) return std::nullopt;
    Reply reply;
    std::optional<Reply::Status> status;
    std::string_view key;
    while (scanner.next_member(key)) {
        std::string_view value;
        if (!scanner.plain_string(value)) return std::nullopt;
        if (key == "status")
            status = status_named(value);
        else if (key == "id")
            reply.id = value;
        else if (key == "proof")
            reply.proof = value;
        else if (key == "by")
            reply.by = value;
        else if (key == kClockName)
            reply.clock = value;
        else if (key == "reason")
            reply.reason = value;
        else if (key == "error")
            reply.error = value;
        else
            return std::nullopt;
    }
    if (!scanner.left() || !scanner.at_end() || !status) return std::nullopt;
    reply.status = *status;
    return reply;
}

constexpr std::array kWords = {
    AnswerWords{S::kTimeout, "", "the board gave no proof in time"},
    AnswerWords{S::kTimeout, kTimeoutDoubt, "something on the line to the board was lost or damaged"},
    AnswerWords{S::kTimeout, kTimeoutPartly, "some of its lines were sent and others were not"},
    AnswerWords{S::kTimeout, kTimeoutNoValue,
                "it was executed, but the value that was asked for did not come"},
    AnswerWords{S::kTimeout, kTimeoutBoardNotThere, "the board did not confirm it in time"},
    AnswerWords{S::kTimeout, kTimeoutNoAnswer, "nothing answered in time"},
    AnswerWords{S::kTimeout, kTimeoutConnection, "the connection to the broker broke before the answer came"},
    AnswerWords{S::kRefused, kRefusedInvalid, "the board has no such command, or not with these arguments"},
    AnswerWords{S::kRefused, kRefusedQueueFull, "too many commands wait"},
    AnswerWords{S::kRefused, kRefusedBoardNotThere, "the board is not there"},
    AnswerWords{S::kRefused, kRefusedDeadline, "its time was over before it could be sent"},
    AnswerWords{S::kRefused, kRefusedIdReused, "another command had this id within the last minute"},
    AnswerWords{S::kRefused, kRefusedRetained, "a stored command is never executed"},
    AnswerWords{S::kRefused, kRefusedStopped, "the board was stopped"},
    AnswerWords{S::kRefused, kRefusedNotHeld, "there is nothing to renew"},
    AnswerWords{S::kRefused, kRefusedReleased, "the port is in other hands"},
    AnswerWords{S::kRefused, kRefusedNotReleased, "the port was not released"},
    AnswerWords{S::kRefused, kRefusedSpeaksAsip, "the board runs ASIP already"},
    AnswerWords{S::kRefused, kRefusedNotLoaded, "the firmware was not loaded"},
    AnswerWords{S::kRefused, kRefusedNotKept, "it could not be kept"},
    AnswerWords{S::kRefused, kRefusedDenied, "the broker's access rules deny it"},
};

}  // namespace

std::string_view to_string(Reply::Status status) {
    switch (status) {
        case Reply::Status::kOk:
            return "ok";
        case Reply::Status::kError:
            return "error";
        case Reply::Status::kTimeout:
            return "timeout";
        case Reply::Status::kRefused:
            return "refused";
    }
    return "refused";
}

std::string ReplyTo::key() const {
    return id.empty() ? correlation : id;
}

Reply Reply::ok(std::string proof, std::string answer) {
    Reply reply;
    reply.proof = std::move(proof);
    reply.answer = std::move(answer);
    return reply;
}

Reply Reply::board_error(int code, std::string error) {
    Reply reply;
    reply.status = Status::kError;
    reply.code = code;
    reply.error = std::move(error);
    return reply;
}

Reply Reply::timeout(std::string_view reason) {
    Reply reply;
    reply.status = Status::kTimeout;
    reply.reason = reason;
    return reply;
}

Reply Reply::refused(std::string reason, std::string error) {
    Reply reply;
    reply.status = Status::kRefused;
    reply.reason = std::move(reason);
    reply.error = std::move(error);
    return reply;
}

std::string to_json_text(const Reply& reply) {
    std::string out = "{";
    const auto begin_member = [&out](std::string_view name) {
        if (out.size() > 1) out += ',';
        out.append("\"").append(name).append("\":");
    };
    const auto text = [&](std::string_view name, std::string_view value) {
        if (value.empty()) return;
        begin_member(name);
        append_json_text(out, value);
    };
    if (!reply.answer.empty()) {
        begin_member("answer");
        out += answer_text(reply.answer);
    }
    text("by", reply.by);
    text(kClockName, reply.clock);
    if (reply.status == Reply::Status::kError) {
        begin_member("code");
        out += std::to_string(reply.code);
    }
    text("error", reply.error);
    text("id", reply.id);
    text("proof", reply.proof);
    text("reason", reply.reason);
    text("status", to_string(reply.status));
    return out += '}';
}

Expected<Reply> parse_reply(std::string_view text) {
    if (auto reply = plain_reply(text)) return std::move(*reply);
    if (!model::json_depth_within(text, kMaxJsonDepth + 1)) return fail("reply is nested too deeply");
    const auto object = json::parse(text, nullptr, false);
    if (!object.is_object()) return fail("reply is not a JSON object");
    const auto status = status_named(text_member(object, "status"));
    if (!status) return fail("reply has no known status");
    Reply reply;
    reply.status = *status;
    reply.id = text_member(object, "id");
    reply.proof = text_member(object, "proof");
    reply.error = text_member(object, "error");
    reply.reason = text_member(object, "reason");
    reply.by = text_member(object, "by");
    reply.clock = text_member(object, kClockName.data());
    if (const auto code = object.find("code"); code != object.end() && code->is_number_integer()) {
        const auto number = code->get<std::int64_t>();
        if (number >= 0 && number <= std::numeric_limits<int>::max()) reply.code = static_cast<int>(number);
    }
    if (const auto answer = object.find("answer"); answer != object.end()) reply.answer = dump(*answer);
    return reply;
}

std::optional<mqtt::Message> reply_message(const ReplyTo& to, Reply reply) {
    if (!to.wanted()) return std::nullopt;
    reply.id = to.id;
    reply.by = to.by;
    mqtt::Message message;
    if (to.properties && !reply.clock.empty())
        message.user_properties.emplace_back(kClockName, std::exchange(reply.clock, {}));
    message.topic = to.topic;
    message.payload = to_json_text(reply);
    message.qos = 1;
    message.correlation = to.correlation;
    return message;
}

std::span<const AnswerWords> answer_words() {
    return kWords;
}

std::string_view words_of(Reply::Status status, std::string_view reason) {
    const auto* const found = std::find_if(kWords.begin(), kWords.end(), [&](const AnswerWords& each) {
        return each.status == status && each.reason == reason;
    });
    return found == kWords.end() ? std::string_view() : found->words;
}

bool may_have_been_executed(const Reply& reply) {
    return reply.status == S::kTimeout && reply.reason != kTimeoutNoValue;
}

Reply read_answer(std::string_view payload) {
    if (auto reply = parse_reply(payload)) return std::move(*reply);
    auto none = Reply::timeout();
    none.error = "the answer cannot be read";
    return none;
}

std::string why_of(const Reply& reply) {
    std::string why = reply.error;
    if (why.empty()) why = words_of(reply.status, reply.reason);
    // A reason of a later version.
    if (why.empty() && reply.status == S::kTimeout) why = words_of(reply.status, {});
    if (why.empty()) why = reply.reason;
    if (may_have_been_executed(reply)) why += kMayHaveBeenExecuted;
    return why;
}

std::string sentence_of(const Reply& reply) {
    const auto why = why_of(reply);
    if (reply.status == S::kError)
        return "the board refused it" + (why.empty() ? "" : ": " + why) + " (error " +
               std::to_string(reply.code) + ")";
    if (reply.status != S::kRefused) return why;
    return "refused" + (reply.reason.empty() ? "" : " (" + reply.reason + ")") +
           (why == reply.reason ? "" : ": " + why);
}

}  // namespace asip::bus
