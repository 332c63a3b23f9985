// SPDX-License-Identifier: Apache-2.0
#include "registry/query_endpoint.hpp"

#include "asip/bus/request_envelope.hpp"

namespace asip::registry {
namespace {

// Long enough for the answer of another registry, which keeps a history.
constexpr Duration kOthersFirst = std::chrono::milliseconds(500);
constexpr std::size_t kMaxLater = 1000;

bool wants_history(const Queries::Request& request) {
    const auto* query = std::get_if<bus::Query>(&request);
    return query != nullptr && query->find == bus::Find::kHistory;
}

mqtt::Message message_of(bus::Answer answer, const bus::ReplyTo& reply) {
    answer.id = reply.id;
    mqtt::Message out;
    out.topic = reply.topic;
    out.correlation = reply.correlation;
    out.qos = 1;
    out.payload = bus::encode(answer);
    return out;
}

}  // namespace

void QueryEndpoint::request(const mqtt::Message& message, bool to_any, Time now) {
    const auto envelope = bus::open_envelope(message);
    const bus::ReplyTo reply = envelope ? envelope->reply : envelope.error().reply;
    if (message.retain || !reply.wanted() || !may_answer_(reply.topic)) return;
    const auto publish = [this, reply](bus::Answer answer) {
        publish_(message_of(std::move(answer), reply));
    };
    if (!envelope) return publish(queries_.refuse("invalid", envelope.error().error));
    if (envelope->form != bus::RequestEnvelope::Form::kJson) {
        return publish(queries_.refuse("invalid", "a query is a JSON object, such as {\"find\":\"boards\"}"));
    }
    const auto request = bus::read_registry_request(envelope->object);
    if (!request) return publish(queries_.refuse("invalid", request.error()));
    if (to_any && wants_history(*request) && !queries_.keeps_history()) {
        later_.push_back({now + kOthersFirst, message_of(queries_.refuse_history(), reply)});
        return;
    }
    queries_.answer(*request, max_bytes_, publish);
}

void QueryEndpoint::tick(Time now) {
    for (; !later_.empty() && (now >= later_.front().due || later_.size() > kMaxLater); later_.pop_front())
        publish_(std::move(later_.front().answer));
}

}  // namespace asip::registry
