// SPDX-License-Identifier: Apache-2.0
#include "registry/query_endpoint.hpp"

#include "asip/bus/request/request_envelope.hpp"

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

std::optional<QueryEndpoint::Question> QueryEndpoint::read(const mqtt::Message& message) {
    const auto envelope = bus::open_envelope(message);
    const bus::ReplyTo reply = envelope ? envelope->reply : envelope.error().reply;
    if (message.retain || !reply.wanted() || !may_answer_(reply.topic)) return std::nullopt;
    const auto refuse = [&](const std::string& error) {
        publish(queries_.refuse("invalid", error), reply);
        return std::nullopt;
    };
    if (!envelope) return refuse(envelope.error().error);
    if (envelope->form != bus::RequestEnvelope::Form::kJson)
        return refuse("a query is a JSON object, such as {\"find\":\"boards\"}");
    auto request = bus::read_registry_request(envelope->object);
    if (!request) return refuse(request.error());
    return Question{reply, std::move(*request)};
}

void QueryEndpoint::publish(bus::Answer answer, const bus::ReplyTo& reply) {
    publish_(message_of(std::move(answer), reply));
}

void QueryEndpoint::request(const mqtt::Message& message, bool to_any, Time now) {
    const auto question = read(message);
    if (!question) return;
    const auto& [reply, request] = *question;
    const auto* forget = std::get_if<bus::Forget>(&request);
    if (forget != nullptr && !forget->dry_run && !forget_topic_.empty())
        return publish(queries_.refuse("denied", "where the broker knows its users, a registry is asked on " +
                                                     forget_topic_ + " to forget a board"),
                       reply);
    if (to_any && wants_history(request) && !queries_.keeps_history()) {
        later_.push_back({now + kOthersFirst, message_of(queries_.refuse_history(), reply)});
        return;
    }
    queries_.answer(request, max_bytes_,
                    [this, to = reply](bus::Answer answer) { publish(std::move(answer), to); });
}

void QueryEndpoint::forget(const mqtt::Message& message) {
    const auto question = read(message);
    if (!question) return;
    if (!std::holds_alternative<bus::Forget>(question->request))
        return publish(queries_.refuse("invalid", R"(a request to forget is such as {"forget":"uno1"})"),
                       question->reply);
    queries_.answer(question->request, max_bytes_,
                    [this, to = question->reply](bus::Answer answer) { publish(std::move(answer), to); });
}

void QueryEndpoint::tick(Time now) {
    for (; !later_.empty() && (now >= later_.front().due || later_.size() > kMaxLater); later_.pop_front())
        publish_(std::move(later_.front().answer));
}

}  // namespace asip::registry
