#pragma once
#include <cstddef>
#include <string>
#include <string_view>

#include "asip/bus/reply.hpp"
#include "asip/expected.hpp"
#include "asip/mqtt/message.hpp"

namespace asip::bus {

/// Bounds of what is accepted from strangers; anything beyond is refused before it is parsed.
inline constexpr std::size_t kMaxRequestBytes = 16384;
inline constexpr int kMaxJsonDepth = 16;
inline constexpr std::size_t kMaxRequestIdBytes = 128;
inline constexpr std::size_t kMaxCorrelationBytes = 256;
inline constexpr std::size_t kMaxReplyTopicBytes = 512;

/// A request without what says where its answer goes.
struct RequestEnvelope {
    /// kJson: `body` is the JSON object without `reply_to` and `id`. kRaw: `body` is ASIP text, either the
    /// payload as it came or the `raw` member of `{"raw":"#,?","reply_to":"...","id":"..."}`.
    enum class Form { kJson, kRaw };
    Form form = Form::kRaw;
    std::string body;
    ReplyTo reply;
};

/// A request that cannot be read, and where to say so: `reply.wanted()` where that much could be made out.
struct BadRequest {
    ReplyTo reply;
    std::string error;  ///< a sentence for a person
};

/// Takes the envelope off a control payload or registry query. Where both are given, the MQTT 5 response
/// topic wins over `reply_to`. A payload whose first character after white space is `{` must be a JSON
/// object, any other is raw text. Refuses: too long, nested too deeply, broken JSON, an `id` that is neither
/// a string nor a number or too long, a reply topic with wildcards, control characters, a leading `$` or too
/// long. Any bytes may be given; whether the message was retained is the caller's to judge.
Expected<RequestEnvelope, BadRequest> open_envelope(const mqtt::Message& request);

}  // namespace asip::bus
