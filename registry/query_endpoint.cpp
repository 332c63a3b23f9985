// SPDX-License-Identifier: Apache-2.0
#include "registry/query_endpoint.hpp"

#include "asip/bus/request_envelope.hpp"

namespace asip::registry {

void QueryEndpoint::request(const mqtt::Message& message) {
    const auto envelope = bus::open_envelope(message);
    const bus::ReplyTo reply = envelope ? envelope->reply : envelope.error().reply;
    if (message.retain || !reply.wanted() || !may_answer_(reply.topic)) return;
    const auto publish = [this, reply](bus::Answer answer) {
        answer.id = reply.id;
        mqtt::Message out;
        out.topic = reply.topic;
        out.correlation = reply.correlation;
        out.qos = 1;
        out.payload = bus::encode(answer);
        publish_(std::move(out));
    };
    if (!envelope) return publish(queries_.refuse("invalid", envelope.error().error));
    if (envelope->form != bus::RequestEnvelope::Form::kJson) {
        return publish(queries_.refuse("invalid", "a query is a JSON object, such as {\"find\":\"boards\"}"));
    }
    const auto request = bus::read_registry_request(envelope->object);
    if (!request) return publish(queries_.refuse("invalid", request.error()));
    queries_.answer(*request, max_bytes_, publish);
}

}  // namespace asip::registry
