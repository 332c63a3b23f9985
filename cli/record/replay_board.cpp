// SPDX-License-Identifier: Apache-2.0
#include "cli/record/replay_board.hpp"

#include <utility>

#include "asip/model/names.hpp"

namespace asip::cli {

using bus::TopicKind;
using member::Announcements;

namespace {

/// Three times within the time for which a name holds.
constexpr std::chrono::seconds kNamesEvery{model::kDefaultLeaseSeconds / 3};

}  // namespace

void ReplayBoard::Recorded::take(const RecordedMessage& message) {
    if (message.kind == TopicKind::kDescription && !first)
        if (auto parsed = model::parse_description(message.payload)) first = std::move(*parsed);
    if (message.kind == TopicKind::kServiceOut || message.kind == TopicKind::kServiceError)
        services.insert(message.service);
    if (message.kind == TopicKind::kServiceNames && model::valid_name(message.payload))
        services.insert(message.payload);
}

ReplayBoard::ReplayBoard(const bus::Topics& topics, Identity identity, const Recorded& recorded,
                         Random random)
    : topics_(topics),
      identity_(std::move(identity)),
      bystander_(topics, identity_.name, std::string(kRefusedRecorded),
                 "this board is a recording; it executes nothing"),
      services_(recorded.services) {
    const auto& first = recorded.first;
    if (!first) return;
    auto options = identity_.announcer;
    options.board = identity_.name;
    options.lease_seconds = first->lease;
    announcer_.emplace(topics_, std::move(options), std::move(random));
    describe(*first);
}

void ReplayBoard::describe(model::Description description) {
    description.link = {std::string(kReplayLink), identity_.source, 0};
    description.agent = identity_.agent;
    description.session.clear();
    description.seq = 0;
    if (described_ == description) return;  // it was renewed
    described_ = description;
    announcer_->describe(std::move(description));
}

std::optional<mqtt::Message> ReplayBoard::will() const {
    return announcer_ ? std::optional(announcer_->will()) : std::nullopt;
}

std::vector<member::Announcer::Subscription> ReplayBoard::subscriptions() const {
    auto all = bystander_.subscriptions();
    if (announcer_)
        for (auto& one : announcer_->subscriptions())
            all.push_back(std::move(one));
    return all;
}

void ReplayBoard::on_connected(Time now, Announcements& out) {
    connected_ = true;
    if (announcer_) return announcer_->on_connected(now, out);
    publish_names(now, out);
}

void ReplayBoard::publish_names(Time now, Announcements& out) {
    named_ = now;
    const auto publish = [&out](std::string topic, std::string name) {
        mqtt::Message message;
        message.topic = std::move(topic);
        message.payload = std::move(name);
        message.qos = 1;
        out.publish.push_back({std::move(message), mqtt::Priority::kAnnouncement});
    };
    if (identity_.announcer.on_shared_topic) publish(topics_.board_names(), identity_.name);
    for (const auto& service : services_)
        publish(topics_.service_names(identity_.name), service);
}

void ReplayBoard::on_subscribed(Time now, Announcements& out) {
    if (announcer_) announcer_->on_subscribed(now, out);
}

void ReplayBoard::on_disconnected() {
    connected_ = false;
    if (announcer_) announcer_->on_disconnected();
}

void ReplayBoard::on_message(const mqtt::Message& message, Time now, Announcements& out) {
    if (!topics_.parse(message.topic)) return;
    if (!bystander_.is_command(message)) {
        if (announcer_) announcer_->on_message(message, now, out);
    } else if (ready()) {
        bystander_.refuse(message, out);
    }
}

void ReplayBoard::tick(Time now, Announcements& out) {
    if (announcer_) return announcer_->tick(now, out);
    if (connected_ && now - named_ >= kNamesEvery) publish_names(now, out);
}

bool ReplayBoard::ready() const {
    return announcer_ ? announcer_->may_publish() : connected_;
}

void ReplayBoard::play(const RecordedMessage& message, Time now, Announcements& out) {
    mqtt::Message copy;
    switch (message.kind) {
        case TopicKind::kBoardIn:
        case TopicKind::kServiceIn:
        case TopicKind::kStop:
        case TopicKind::kLink:
            return;  // what it was asked is there to be read, not to be asked again
        case TopicKind::kDescription:
            if (auto description = model::parse_description(message.payload); announcer_ && description) {
                const auto said = description->state;
                describe(std::move(*description));
                if (said) announcer_->set_state(said->state, said->reason, now, out);
            }
            return;
        case TopicKind::kState:
            if (const auto state = model::board_state_from_text(message.payload);
                announcer_ && state && *state != announcer_->state())
                announcer_->set_state(*state, model::reason_of_word(*state), now, out);
            return;
        case TopicKind::kBoardNames:
        case TopicKind::kServiceNames:
            return;  // it is announced anyway
        default:
            if (message.retained) return;  // from before the recording began
            copy.payload = message.payload;
    }
    copy.topic = topic_of(topics_, message, identity_.name);
    out.publish.push_back({std::move(copy), mqtt::Priority::kContext});
}

void ReplayBoard::goodbye(Time now, Announcements& out) {
    if (announcer_) announcer_->goodbye(now, out);
}

}  // namespace asip::cli
