// SPDX-License-Identifier: Apache-2.0
#include "asip/member/bystander.hpp"

#include <utility>

#include "asip/bus/request/reply.hpp"
#include "asip/bus/request/request_envelope.hpp"

namespace asip::member {

using bus::TopicKind;

Bystander::Bystander(const bus::Topics& topics, std::string board, std::string reason, std::string text)
    : topics_(topics), board_(std::move(board)), reason_(std::move(reason)), text_(std::move(text)) {}

std::vector<Announcer::Subscription> Bystander::subscriptions() const {
    std::vector<Announcer::Subscription> all;
    for (const auto& filter :
         {topics_.board_in(board_), topics_.service_in(board_, "+"), topics_.stop(board_)})
        all.push_back({filter, {.qos = 1}});
    return all;
}

bool Bystander::is_command(const mqtt::Message& message) const {
    const auto topic = topics_.parse(message.topic);
    return topic && (topic->kind == TopicKind::kBoardIn || topic->kind == TopicKind::kServiceIn ||
                     topic->kind == TopicKind::kStop);
}

void Bystander::refuse(const mqtt::Message& command, Announcements& out) const {
    if (command.retain) return;
    const auto envelope = bus::open_envelope(command);
    auto reply = bus::reply_message(envelope ? envelope->reply : envelope.error().reply,
                                    bus::Reply::refused(reason_, text_));
    if (reply) out.publish.push_back({std::move(*reply), mqtt::Priority::kReply});
}

}  // namespace asip::member
