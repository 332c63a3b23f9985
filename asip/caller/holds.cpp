// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "asip/caller/entries.hpp"
#include "asip/model/json.hpp"

namespace asip::caller {
namespace {

// A request line becomes the member "raw".
std::string held(const std::string& payload, std::chrono::milliseconds hold) {
    auto document = model::parse_json(payload);
    auto object = document && document->is_object() ? std::move(*document) : nlohmann::json{{"raw", payload}};
    object["hold_ms"] = hold.count();
    return model::dump_json(object);
}

}  // namespace

Caller::Hold Caller::hold(Command command, std::chrono::milliseconds hold, Done begun, Done ended, Time now) {
    const auto entry =
        std::make_shared<Hold::Entry>(Hold::Entry{command.topic, hold, std::move(begun), std::move(ended)});
    command.payload = held(command.payload, hold);
    entry->call = this->command(
        std::move(command),
        [this, weak = std::weak_ptr(entry)](const bus::Reply& reply) {
            if (const auto held = weak.lock()) begin_hold(held, reply);
        },
        now);
    entry->id = entry->call.id();
    holds_.push_back(entry);
    return Hold(entry);
}

void Caller::begin_hold(const std::shared_ptr<Hold::Entry>& hold, const bus::Reply& reply) {
    if (reply.succeeded()) hold->next = now_;
    if (hold->begun) hold->begun(reply);
}

// Two of three may get lost.
void Caller::renew(const std::shared_ptr<Hold::Entry>& hold, Time now) {
    const auto between = std::max<Duration>(hold->hold / 3, std::chrono::milliseconds(10));
    hold->next = now + between;
    if (access_.why_lost()) return;
    mqtt::Message message{
        .topic = hold->topic,
        .payload = model::dump_json({{"renew", hold->id}, {"hold_ms", hold->hold.count()}})};
    message.expire_after(hold->hold);
    hold->renewal = ask(
        std::move(message),
        [weak = std::weak_ptr(hold)](const mqtt::Message& answer) {
            const auto held = weak.lock();
            const auto reply = bus::parse_reply(answer.payload);
            if (!held || !held->next || !reply || reply->succeeded()) return;
            held->next.reset();
            if (held->ended) held->ended(*reply);
        },
        now);
}

}  // namespace asip::caller
