// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "asip/expected.hpp"
#include "asip/mqtt/message.hpp"

namespace asip::bus {

// What each of these words means to a person is in reply.cpp; tests/vectors/answers.json binds it.

/// Reasons of Reply::kRefused that every program knows.
inline constexpr std::string_view kRefusedQueueFull = "queue-full";
inline constexpr std::string_view kRefusedInvalid = "invalid";
inline constexpr std::string_view kRefusedBoardNotThere = "board-not-there";
inline constexpr std::string_view kRefusedRetained = "retained";
inline constexpr std::string_view kRefusedDeadline = "deadline";
/// It waited while the board was stopped.
inline constexpr std::string_view kRefusedStopped = "stopped";
/// There is nothing to renew.
inline constexpr std::string_view kRefusedNotHeld = "not-held";
inline constexpr std::string_view kRefusedIdReused = "id-reused";
/// A program says it of its own command: the access rules of the broker deny the topic.
inline constexpr std::string_view kRefusedDenied = "denied";

/// Reasons of Reply::kTimeout: something on the line to the board was lost or damaged, so that it may or may
/// not have executed the command; and: it executed the command, but the value that was asked for did not
/// come.
inline constexpr std::string_view kTimeoutDoubt = "doubt";
inline constexpr std::string_view kTimeoutNoValue = "no-value";
/// Some lines of a command were sent and others were not.
inline constexpr std::string_view kTimeoutPartly = "partly";
/// The board was not there to confirm a stop.
inline constexpr std::string_view kTimeoutBoardNotThere = "board-not-there";
/// A program says it of its own command: not even an agent answered.
inline constexpr std::string_view kTimeoutNoAnswer = "no-answer";
/// The same: its connection was lost before the answer came.
inline constexpr std::string_view kTimeoutConnection = "connection";

/// Where and under which names the answer to one request goes.
struct ReplyTo {
    std::string topic;        ///< empty: no answer is wanted
    std::string correlation;  ///< MQTT 5 correlation data, sent back as it came
    std::string id;           ///< the requester's `id`, sent back inside the JSON
    /// The requester's name, as it says itself (a gateway: the name of the token); sent back inside the JSON.
    std::string by{};
    bool properties = false;  ///< asked over MQTT 5: the answer may have user properties
    bool clock = false;       ///< the agent's clock is wanted with the answer

    bool wanted() const { return !topic.empty(); }

    /// What distinguishes this request from others of the same requester: the id, else the correlation data;
    /// empty when there is neither, and then a repetition cannot be recognised.
    std::string key() const;

    friend bool operator==(const ReplyTo&, const ReplyTo&) = default;
};

/// The one final answer to a command.
struct Reply {
    enum class Status {
        /// Executed; `proof` says how that is known, `answer` holds what the board answered, if anything.
        kOk,
        /// The board refused: `code` and `error` are from its answer.
        kError,
        /// No evidence within the time limit; `reason` may name the cause.
        kTimeout,
        /// Never sent to the board: `reason` is a word for programs, `error` a sentence for a person.
        kRefused,
    };

    std::string id{};
    Status status = Status::kOk;
    std::string proof{};   ///< "fence", or "answer"
    std::string answer{};  ///< JSON text; empty: none
    int code = 0;          ///< ASIP error number
    std::string error{};   ///< for a person
    std::string reason{};  ///< a word of refusal_reasons.hpp
    std::string by{};      ///< ReplyTo::by
    std::string clock{};   ///< the agent's clock when it answered: AgentClock::read()

    static Reply ok(std::string proof, std::string answer = {});
    static Reply board_error(int code, std::string error);
    /// `reason`: kTimeoutDoubt, kTimeoutNoValue, or none.
    static Reply timeout(std::string_view reason = {});
    static Reply refused(std::string reason, std::string error);

    bool succeeded() const { return status == Status::kOk; }
    friend bool operator==(const Reply&, const Reply&) = default;
};

/// "ok", "error", "timeout" or "refused". Static storage.
std::string_view to_string(Reply::Status status);

/// The JSON text of a reply, `{"id":"7","status":"ok","proof":"fence"}`. Bytes of id, error and reason that
/// are not UTF-8 are replaced; an `answer` that is not JSON becomes a JSON string.
std::string to_json_text(const Reply& reply);

/// Reads what to_json_text() wrote, by whichever version: unknown members are ignored. Fails with a reason
/// for anything that is not a JSON object with a known `status`.
Expected<Reply> parse_reply(std::string_view text);

/// The message that carries `reply` (its id and `by` filled in from `to`) to the topic in `to`, with QoS 1;
/// nothing when no answer is wanted. Where it may have user properties, the clock is one.
std::optional<mqtt::Message> reply_message(const ReplyTo& to, Reply reply);

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
