// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "asip/caller/caller.hpp"

namespace asip::caller {

void Caller::publish_demands(Time now) {
    for (auto& message : demander_.due(now))
        port_.publish(std::move(message));
}

Caller::Subscription Caller::subscribe(const std::string& filter, mqtt::Router::OnMessage on_message,
                                       mqtt::SubscribeOptions options) {
    auto subscription = router_.add(filter, std::move(on_message));
    port_.subscribe(filter, options);
    return subscription;
}

void Caller::listen(const std::string& filter) {
    if (listened_.insert(filter).second) port_.subscribe(filter, {.qos = options_.qos});
}

void Caller::watch(const std::string& board) {
    listen(topics().state(board));
    watch_description(board);
}

void Caller::watch_description(const std::string& board) {
    listen(topics().description(board));
}

void Caller::watch_names(const std::string& board) {
    listen(topics().service_names(board));
}

void Caller::watch_all() {
    listen(topics().board_names());
    listen(topics().board_names() + "/+/+");
    listen(topics().service_names("+"));
}

void Caller::look_at(const mqtt::Message& message, Time now) {
    demander_.take(message, now);
    publish_demands(now);
    if (listened_.empty()) return;
    const auto board = view_.apply(message, now);
    lease_over_ = view_.next_expiry();
    if (board.empty()) return;
    const bool state = message.topic == topics().state(board);
    if (state || !message.retain) told_.insert(board);
    if (port_.changed) port_.changed(board, &message);
}

void Caller::look_at_leases(Time now) {
    if (!lease_over_ || *lease_over_ > now) return;
    for (const auto& board : view_.expired(now))
        if (port_.changed) port_.changed(board, nullptr);
    lease_over_ = view_.next_expiry();
}

Caller::Mark Caller::mark_retained() {
    const auto topic = replies().below("mark" + std::to_string(++marks_)).own();
    Mark mark;
    mark.at_ = std::make_shared<std::optional<Time>>();
    mark.subscription_ = subscribe(topic,
                                   [this, at = mark.at_](const mqtt::Message&) {
                                       if (!*at) *at = now_;
                                   },
                                   {.qos = 1});
    mqtt::Message message{.topic = topic, .payload = "mark"};
    message.qos = 1;  // of QoS 0 it would overtake messages of QoS 1 that wait
    publish(std::move(message));
    return mark;
}

}  // namespace asip::caller
