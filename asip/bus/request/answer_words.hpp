// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <string_view>

#include "asip/bus/request/reply.hpp"

/// What an answer to a command means, in words for a person: the same in every program and language.
/// tests/vectors/answers.json binds them.
namespace asip::bus {

/// Ends each sentence about a command that the board may have executed or not.
inline constexpr std::string_view kMayHaveBeenExecuted = "; it may or may not have been executed";

/// Whether the board may have executed the command or not: so behind every timeout, but for one that lacks
/// the value alone.
bool may_have_been_executed(const Reply& reply);

/// One sentence without its full stop; empty for a success. What the answer says itself (`error`) comes
/// before what is known of its reason.
std::string sentence_of(const Reply& reply);
/// The same where the status stands beside it already.
std::string why_of(const Reply& reply);

/// What came as an answer; where it is none, an answer that says so.
Reply read_answer(std::string_view payload);

/// A status with a reason, and what it means.
struct AnswerWords {
    Reply::Status status;
    std::string_view reason;
    std::string_view words;
};
/// All that programs of this version send or make.
std::span<const AnswerWords> answer_words();
/// Empty for a reason of a later version.
std::string_view words_of(Reply::Status status, std::string_view reason);

}  // namespace asip::bus
