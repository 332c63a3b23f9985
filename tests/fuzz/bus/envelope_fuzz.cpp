// SPDX-License-Identifier: Apache-2.0
// Control payloads and command answers from strangers: refused or read, and what was read can be written and
// read again.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "asip/bus/request/agent_clock.hpp"
#include "asip/bus/request/reply.hpp"
#include "asip/bus/request/request_envelope.hpp"
#include "asip/model/json.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace asip::bus;
    const std::string text(reinterpret_cast<const char*>(data), size);
    asip::mqtt::Message message;
    message.payload = text;
    if (const auto envelope = open_envelope(message)) {
        static const AgentClock clock([] { return std::uint64_t{0}; });
        AgentClocks clocks;
        clocks.note("uno1", envelope->sent, {}, {});
        if (const auto sent = clock.time_of(envelope->sent); sent && *sent < asip::Time()) std::abort();
        if (clock.time_of(clocks.reading("uno1", {})).value_or(asip::Time()) < asip::Time()) std::abort();
        if (envelope->reply.id.size() > kMaxRequestIdBytes) std::abort();
        if (envelope->form == RequestEnvelope::Form::kJson &&
            !asip::model::json_depth_within(envelope->shown(), kMaxJsonDepth)) {
            std::abort();
        }
    } else if (envelope.error().error.empty()) {
        std::abort();
    }
    if (const auto reply = parse_reply(text)) {
        const auto again = parse_reply(to_json_text(*reply));
        if (!again || again->status != reply->status || again->id != reply->id) std::abort();
    }
    return 0;
}
