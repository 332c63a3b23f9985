// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "asip/bus/request/reply.hpp"
#include "asip/bus/topics.hpp"
#include "asip/expected.hpp"
#include "asip/mqtt/message.hpp"

namespace asip::bus {

/// For a user of the broker: `$nobody` where the name is empty or no level.
std::string user_level(std::string_view user);

/// The USER of an answer's topic, or that topic. A broker without users has all askers under one name.
std::string asker_of(const std::string& reply_topic);

/// Where a program's answers come: ROOT/reply/USER/ASKED/CLIENT, USER being the program's, ASKED the board or
/// `registry`, CLIENT the program's own. Access rules can keep others from reading an answer (by USER) and
/// from faking one (by ASKED). Where the broker has no users, any topic serves; else see may_answer_on().
class ReplyTopics {
  public:
    /// `user` becomes user_level(). `client`: valid levels.
    ReplyTopics(const Topics& topics, std::string_view user, std::string_view client);

    /// CLIENT becomes CLIENT/`level`.
    ReplyTopics below(std::string_view level) const;
    /// CLIENT becomes CLIENT-urgent: for answers that wait behind no others.
    ReplyTopics urgent() const;
    /// The topic of the same client that is not urgent.
    static std::string without_urgent(std::string topic);

    /// Subscribe to it before the first request.
    std::string filter() const { return of("+"); }
    /// Where the answer to a request on `request_topic` comes.
    std::string to(std::string_view request_topic) const { return of(asked(request_topic)); }
    /// A board, or `registry`.
    std::string_view asked(std::string_view request_topic) const;
    /// Only the program itself writes and reads it.
    std::string own() const { return of("$self"); }
    /// The topic matches filter().
    bool have(std::string_view topic) const;
    /// The topic is of some program of this user.
    bool of_user(std::string_view topic) const { return topic.starts_with(prefix_); }

  private:
    std::string of(std::string_view asked) const;

    std::string root_;    // with a slash behind it
    std::string prefix_;  // ROOT/reply/USER/
    std::string client_;  // with a slash in front of it
};

/// `answerer`, a board or `registry`, answers on ROOT/reply/USER/ANSWERER/CLIENT alone where the broker knows
/// its users: the requester names the topic, and access rules let the answerer write more.
bool may_answer_on(std::string_view topic, const Topics& topics, std::string_view answerer);

/// Limits of each request on the bus, refused before it is parsed.
inline constexpr std::size_t kMaxRequestBytes = 16384;  ///< of the payload
inline constexpr int kMaxJsonDepth = 16;                ///< of objects and arrays
inline constexpr std::size_t kMaxRequestIdBytes = 128;
inline constexpr std::size_t kMaxCorrelationBytes = 256;
inline constexpr std::size_t kMaxReplyTopicBytes = 512;
inline constexpr std::size_t kMaxByBytes = 64;  ///< of the sender; of a longer name the beginning counts
/// Bounds of `deadline_ms`.
inline constexpr std::chrono::milliseconds kMinDeadline{50};
inline constexpr std::chrono::milliseconds kMaxDeadline{60'000};
/// Bounds of `hold_ms`.
inline constexpr std::chrono::milliseconds kMinHold{50};
inline constexpr std::chrono::milliseconds kMaxHold{60'000};

/// Without where its answer goes.
struct RequestEnvelope {
    enum class Form {
        kJson,  ///< `object` is the request
        kRaw,   ///< `text` is the request: the payload, or the member of `{"raw":"#,?","id":"..."}`
    };
    Form form = Form::kRaw;
    /// kJson: without `reply_to`, `id`, `by`, `clock`, `deadline_ms` and `hold_ms`.
    nlohmann::json object;
    std::string text;  ///< kRaw: ASIP text
    ReplyTo reply;
    std::optional<std::chrono::milliseconds> deadline;  ///< `deadline_ms`, kMinDeadline to kMaxDeadline
    std::optional<std::chrono::milliseconds> hold;      ///< `hold_ms`, kMinHold to kMaxHold
    std::string sent;  ///< `clock`: what the agent's clock showed then; empty: not said

    /// For reports: the text, or the JSON.
    std::string shown() const;
};

/// A request that cannot be read. `reply` holds what stands before the fault: ask reply.wanted().
struct BadRequest {
    ReplyTo reply;
    std::string error;  ///< a sentence for a person
};

/// Takes the envelope off a control payload or registry query. The MQTT 5 response topic wins over
/// `reply_to`, user properties `by` and `clock` over the members. A payload that begins with `{` behind white
/// space must be a JSON object; any other is raw text. Refuses what is too long, too deep or broken, a bad
/// `id`, `deadline_ms`, `hold_ms` or reply topic. Any bytes may be given; the caller judges retained
/// messages.
Expected<RequestEnvelope, BadRequest> open_envelope(const mqtt::Message& request);

}  // namespace asip::bus
