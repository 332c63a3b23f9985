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

/// The level of topics that stands for a user of the broker: `$nobody` where the name is empty or no level.
std::string user_level(std::string_view user);

/// Where the answers to one program's requests come: ROOT/reply/USER/ASKED/CLIENT. USER is the program's user
/// of the broker, ASKED the board that is asked or `registry`, CLIENT what no other program has. So the
/// broker's access rules can keep others from reading an answer (by USER), and from giving one for
/// another answerer (by ASKED). Where the broker has no users, answers go to any topic that a request names;
/// else see may_answer_on().
class ReplyTopics {
  public:
    /// `user` becomes user_level(). `client`: one or more levels that are valid in a topic.
    ReplyTopics(const Topics& topics, std::string_view user, std::string_view client);

    /// Topics for the answers to a part of the program's requests: CLIENT becomes CLIENT/`level`.
    ReplyTopics below(std::string_view level) const;
    /// Topics of another client of the same program: CLIENT becomes CLIENT-`suffix`.
    ReplyTopics beside(std::string_view suffix) const;

    /// Subscribe to it before the first request: answers of everybody.
    std::string filter() const { return of("+"); }
    /// Where the answer to a request on `request_topic` comes.
    std::string to(std::string_view request_topic) const { return of(asked(request_topic)); }
    /// The member that is asked on this topic: a board, or `registry`.
    std::string_view asked(std::string_view request_topic) const;
    /// A topic that only the program itself writes and reads.
    std::string own() const { return of("$self"); }
    /// The topic of all programs of this user: own() without CLIENT.
    std::string own_of_all() const { return prefix_ + "$self"; }
    /// Whether the topic matches filter().
    bool have(std::string_view topic) const;
    /// Whether the topic is of this user, and of whichever of its programs.
    bool of_user(std::string_view topic) const { return topic.starts_with(prefix_); }

  private:
    std::string of(std::string_view asked) const;

    std::string root_;    // with a slash behind it
    std::string prefix_;  // ROOT/reply/USER/
    std::string client_;  // with a slash in front of it
};

/// Whether `answerer`, a board or `registry`, answers on this topic where the broker knows its users:
/// ROOT/reply/USER/ANSWERER/CLIENT. The rules of the broker let an answerer write more than that, values of
/// its board for example, and the requester names the topic.
bool may_answer_on(std::string_view topic, const Topics& topics, std::string_view answerer);

/// Limits of a request on the bus, for commands and registry queries alike; the only place where they stand.
/// What is beyond them is refused before it is parsed.
inline constexpr std::size_t kMaxRequestBytes = 16384;  ///< of the payload
inline constexpr int kMaxJsonDepth = 16;                ///< of objects and arrays
inline constexpr std::size_t kMaxRequestIdBytes = 128;
inline constexpr std::size_t kMaxCorrelationBytes = 256;
inline constexpr std::size_t kMaxReplyTopicBytes = 512;
inline constexpr std::size_t kMaxByBytes = 64;  ///< of the sender; of a longer name the beginning counts
/// The shortest and the longest `deadline_ms`: within what time a command is to be answered.
inline constexpr std::chrono::milliseconds kMinDeadline{50};
inline constexpr std::chrono::milliseconds kMaxDeadline{60'000};
/// For how long a command may be held without being renewed.
inline constexpr std::chrono::milliseconds kMinHold{50};
inline constexpr std::chrono::milliseconds kMaxHold{60'000};

/// A request, apart from where its answer goes.
struct RequestEnvelope {
    enum class Form {
        kJson,  ///< `object` is the request
        kRaw,   ///< `text` is the request: the payload, or the member of `{"raw":"#,?","id":"..."}`
    };
    Form form = Form::kRaw;
    /// kJson: the object without `reply_to`, `id`, `by`, `clock`, `deadline_ms` and
    /// `hold_ms`.
    nlohmann::json object;
    std::string text;  ///< kRaw: ASIP text
    ReplyTo reply;
    std::optional<std::chrono::milliseconds> deadline;  ///< `deadline_ms`, kMinDeadline to kMaxDeadline
    std::optional<std::chrono::milliseconds> hold;      ///< `hold_ms`, kMinHold to kMaxHold
    std::string sent;  ///< `clock`: what the agent's clock showed then; empty: not said

    /// The request in words, for reports about it: the text, or the object's JSON text.
    std::string shown() const;
};

/// A request that cannot be read, and where to report that. `reply` holds as much as could be read, of JSON
/// that is broken, too long or too deep what stands before the fault: ask reply.wanted().
struct BadRequest {
    ReplyTo reply;
    std::string error;  ///< a sentence for a person
};

/// Takes the envelope off a control payload or registry query. Where both are given, the MQTT 5 response
/// topic wins over `reply_to`, and the user properties `by` and `clock` over the members. A payload whose
/// first character after white space (and a mark of UTF-8) is `{` must be a JSON object, any other is raw
/// text. Refuses: too long, nested too deeply, broken JSON, an `id` that is neither a string nor a number or
/// too long, a `deadline_ms` or `hold_ms` that is not 50 to 60000, a reply topic with wildcards, control
/// characters, a leading `$` or too long. Any bytes may be given; whether the message was retained is the
/// caller's to judge.
Expected<RequestEnvelope, BadRequest> open_envelope(const mqtt::Message& request);

}  // namespace asip::bus
