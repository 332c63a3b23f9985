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

/// Reasons of Reply::kRefused.
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
/// Said by a program: the broker's access rules deny its command's topic.
inline constexpr std::string_view kRefusedDenied = "denied";

/// Reasons of Reply::kTimeout: something was lost or damaged, so that the board may or may not have executed
/// the command; it did, without the value that was asked for.
inline constexpr std::string_view kTimeoutDoubt = "doubt";
inline constexpr std::string_view kTimeoutNoValue = "no-value";
/// Some lines of a command were sent.
inline constexpr std::string_view kTimeoutPartly = "partly";
/// To confirm a stop.
inline constexpr std::string_view kTimeoutBoardNotThere = "board-not-there";
/// Said by a program: not even an agent answered.
inline constexpr std::string_view kTimeoutNoAnswer = "no-answer";
/// Said by a program: its connection was lost first.
inline constexpr std::string_view kTimeoutConnection = "connection";

/// Where the answer to a request goes.
struct ReplyTo {
    std::string topic;        ///< empty: no answer is wanted
    std::string correlation;  ///< MQTT 5 correlation data, sent back as it came
    std::string id;           ///< the requester's `id`, sent back inside the JSON
    /// The requester's own name (a gateway: the token's), sent back in the JSON.
    std::string by{};
    bool properties = false;  ///< asked over MQTT 5: the answer may have user properties
    bool clock = false;       ///< the agent's clock is wanted with the answer

    bool wanted() const { return !topic.empty(); }

    /// The id, else the correlation data, which make a repetition known; may be empty.
    std::string key() const;

    friend bool operator==(const ReplyTo&, const ReplyTo&) = default;
};

/// The one final answer to a command.
struct Reply {
    enum class Status {
        /// Executed: `proof` says how that is known, `answer` what the board answered.
        kOk,
        /// The board refused, with `code` and `error`.
        kError,
        /// No evidence in time; `reason` may name the cause.
        kTimeout,
        /// Never sent to the board: `reason` a word for programs, `error` a sentence.
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

std::string_view to_string(Reply::Status status);

/// `{"id":"7","status":"ok","proof":"fence"}`. Bytes that are not UTF-8 are replaced; an `answer` that is not
/// JSON becomes a string.
std::string to_json_text(const Reply& reply);

/// Takes any version. Fails where it is no JSON object with a known `status`.
Expected<Reply> parse_reply(std::string_view text);

/// With id and `by` from `to`, QoS 1, and the clock as user property where possible; nothing: no answer is
/// wanted.
std::optional<mqtt::Message> reply_message(const ReplyTo& to, Reply reply);

inline constexpr std::string_view kMayHaveBeenExecuted = "; it may or may not have been executed";

/// True for every timeout that lacks more than the value.
bool may_have_been_executed(const Reply& reply);

/// Without its full stop; empty for a success. `error` comes before what is known of the reason.
std::string sentence_of(const Reply& reply);
/// For a place that shows the status already.
std::string why_of(const Reply& reply);

/// Where `payload` is no answer, an answer that says so.
Reply read_answer(std::string_view payload);

/// A status with a reason, and its meaning.
struct AnswerWords {
    Reply::Status status;
    std::string_view reason;
    std::string_view words;
};
/// All that this version sends or makes.
std::span<const AnswerWords> answer_words();
/// Empty for a reason of a later version.
std::string_view words_of(Reply::Status status, std::string_view reason);

}  // namespace asip::bus
