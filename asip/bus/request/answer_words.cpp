// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/answer_words.hpp"

#include <algorithm>
#include <array>

#include "asip/bus/request/label_request.hpp"
#include "asip/bus/request/port_request.hpp"

namespace asip::bus {
namespace {

using S = Reply::Status;

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
