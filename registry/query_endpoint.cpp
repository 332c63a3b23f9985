// SPDX-License-Identifier: Apache-2.0
#include "registry/query_endpoint.hpp"

#include "asip/bus/json/json_scanner.hpp"
#include "asip/bus/request/reply.hpp"

namespace asip::registry {
namespace {

// Long enough for the answer of another registry, which keeps a history.
constexpr Duration kOthersFirst = std::chrono::milliseconds(500);
constexpr std::size_t kMaxLater = 1000;

bool wants_history(const Queries::Request& request) {
    const auto* query = std::get_if<bus::Query>(&request);
    return query != nullptr && (query->find == bus::Find::kHistory || query->find == bus::Find::kValues);
}

/// Without reading the question; empty: not known.
std::string reply_topic_of(const mqtt::Message& message) {
    if (!message.response_topic.empty()) return message.response_topic;
    bus::JsonScanner scanner(message.payload);
    std::string_view key, value;
    if (!scanner.enter_object()) return {};
    while (scanner.next_member(key)) {
        const bool plain = scanner.plain_string(value);
        if (plain && key == "reply_to") return std::string(value);
        if (!plain && !scanner.value(value)) return {};
    }
    return {};
}

mqtt::Message message_of(bus::Answer answer, const bus::ReplyTo& reply) {
    answer.id = reply.id;
    return mqtt::Message{
        .topic = reply.topic, .payload = bus::encode(answer), .qos = 1, .correlation = reply.correlation};
}

}  // namespace

bool QueryEndpoint::floods(const mqtt::Message& message) const {
    if (refused_.empty()) return false;
    const auto asker = bus::asker_of(reply_topic_of(message));
    const auto told = refused_.find(asker);
    return told != refused_.end() && told->second >= kMaxRefused && waiting_.full_of(asker);
}

std::optional<QueryEndpoint::Question> QueryEndpoint::read(const mqtt::Message& message) {
    if (floods(message)) return std::nullopt;
    const auto envelope = bus::open_envelope(message);
    const bus::ReplyTo reply = envelope ? envelope->reply : envelope.error().reply;
    if (message.retain || !reply.wanted() || !may_answer_(reply.topic)) return std::nullopt;
    const auto invalid = [&](const std::string& error) {
        refuse("invalid", error, reply);
        return std::nullopt;
    };
    if (!envelope) return invalid(envelope.error().error);
    if (envelope->form != bus::RequestEnvelope::Form::kJson)
        return invalid("a query is a JSON object, such as {\"find\":\"boards\"}");
    auto request = bus::read_registry_request(envelope->object);
    if (!request) return invalid(request.error());
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
        return refuse("denied",
                      "where the broker knows its users, a registry is asked on " + forget_topic_ +
                          " to forget a board",
                      reply);
    if (to_any && wants_history(request)) {
        const auto find = std::get<bus::Query>(request).find;
        if (!queries_.keeps(find))
            return void(
                later_.push_back({now + kOthersFirst, message_of(queries_.refuse_kept(find), reply)}));
    }
    take(*question);
}

void QueryEndpoint::take(Question question) {
    auto& waiting = wants_history(question.request) ? of_history_ : waiting_;
    const bool now = waiting.empty() && answered_ < kAtOnce &&
                     !(&waiting == &of_history_ && reads_history_) && takes_answers_();
    if (now) return answer(question);
    const auto asker = bus::asker_of(question.reply.topic);
    const auto left = waiting.push(asker, std::move(question));
    if (left)
        refuse(std::string(bus::kRefusedQueueFull), "too many questions of this asker wait; ask again later",
               left->reply);
}

void QueryEndpoint::refuse(std::string reason, std::string error, const bus::ReplyTo& reply) {
    auto& told = refused_[bus::asker_of(reply.topic)];
    if (refused_.size() > kMaxRefused || ++told > kMaxRefused) return;
    publish(queries_.refuse(std::move(reason), std::move(error)), reply);
}

void QueryEndpoint::answer(const Question& question) {
    ++answered_;
    const bool history = wants_history(question.request);
    if (history) reads_history_ = true;
    queries_.answer(question.request, max_bytes_, [this, history, to = question.reply](bus::Answer answer) {
        if (history) reads_history_ = false;
        publish(std::move(answer), to);
    });
}

void QueryEndpoint::turn() {
    answered_ = 0;
    if (!takes_answers_()) return;
    if (!waiting_.empty()) answer(waiting_.pop());
    if (!of_history_.empty() && !reads_history_) answer(of_history_.pop());
}

void QueryEndpoint::forget(const mqtt::Message& message) {
    const auto question = read(message);
    if (!question) return;
    if (!std::holds_alternative<bus::Forget>(question->request))
        return refuse("invalid", R"(a request to forget is such as {"forget":"uno1"})", question->reply);
    take(*question);
}

void QueryEndpoint::tick(Time now) {
    turn();
    refused_.clear();
    for (; !later_.empty() && (now >= later_.front().due || later_.size() > kMaxLater); later_.pop_front())
        publish_(std::move(later_.front().answer));
}

}  // namespace asip::registry
