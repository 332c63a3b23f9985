// SPDX-License-Identifier: Apache-2.0
#include "agent/program/stop_line.hpp"

#include <algorithm>
#include <utility>

#include "asip/bus/request/request_envelope.hpp"

namespace asip::agent {

namespace {

// A broker that is busy reads one in the time in which it reads thousands of a flood.
constexpr std::size_t kAnswersUnderWay = 8;
constexpr std::size_t kUnderWayWithCommands = 2;

bool same_connection(const mqtt::Options& a, const mqtt::Options& b) {
    return a.brokers == b.brokers && a.user == b.user && a.password == b.password && a.ca_file == b.ca_file &&
           a.cert_file == b.cert_file && a.key_file == b.key_file && a.insecure == b.insecure &&
           a.version == b.version;
}

}  // namespace

StopLine::StopLine(boost::asio::io_context& io, mqtt::Options options) {
    mqtt::Client::Handlers handlers;
    handlers.on_subscribed = [this] {
        tell(true, {});
        send_answers();
    };
    handlers.on_published = [this](const std::string&) { send_answers(); };
    handlers.on_publish_denied = [this](const std::string&, const std::string&) { send_answers(); };
    handlers.on_disconnected = [this](const mqtt::ConnectionFailure& failure) { tell(false, failure.text); };
    handlers.on_connect_failed = [this](const mqtt::ConnectionFailure& failure) {
        tell(false, failure.text);
    };
    handlers.on_message = [this](const mqtt::Message& message) {
        for (const auto& entry : entries())
            if (entry->topic == message.topic) entry->handlers.on_stop(message);
    };
    handlers.on_subscribe_refused = [this](const std::string& filter, const std::string& reason) {
        for (const auto& entry : entries())
            if (entry->topic == filter)
                entry->handlers.on_heard(false, "the broker refuses " + filter + ": " + reason);
    };
    client_ = std::make_shared<mqtt::Client>(io, std::move(options), std::move(handlers));
    client_->start();
}

void StopLine::answer(mqtt::Message message) {
    const auto asker = bus::asker_of(message.topic);
    answers_.push(asker, std::move(message));
    send_answers();
}

std::size_t StopLine::under_way() const {
    const auto counters = client_->counters();
    return counters.queued + counters.unacknowledged;
}

bool StopLine::has_room_for(const mqtt::Message& answer) const {
    return answer.payload.size() <= mqtt::Options::kShortPayload && answers_.empty() &&
           under_way() < kUnderWayWithCommands;
}

void StopLine::send_answers() {
    while (!answers_.empty() && under_way() < kAnswersUnderWay)
        client_->publish(answers_.pop(), mqtt::Priority::kUrgent);
}

std::vector<std::shared_ptr<StopLine::Entry>> StopLine::entries() {
    std::vector<std::shared_ptr<Entry>> left;
    for (const auto& entry : entries_)
        if (auto held = entry.lock()) left.push_back(std::move(held));
    return left;
}

void StopLine::tell(bool heard, const std::string& why) {
    for (const auto& entry : entries())
        entry->handlers.on_heard(heard, why);
}

StopLine::Listening StopLine::listen(std::string topic, Handlers handlers) {
    std::erase_if(entries_, [](const auto& entry) { return entry.expired(); });
    auto* const entry = new Entry{std::move(topic), std::move(handlers)};
    std::shared_ptr<Entry> held(entry, [client = std::weak_ptr(client_)](const Entry* ended) {
        if (const auto connection = client.lock()) connection->unsubscribe(ended->topic);
        delete ended;
    });
    client_->subscribe(held->topic, {.qos = 1, .no_local = true, .required = true});
    entries_.push_back(held);
    return Listening(std::move(held));
}

std::shared_ptr<StopLine> StopLines::line(const mqtt::Options& options) {
    open_.remove_if([](const Open& open) { return open.line.expired(); });
    for (const auto& open : open_)
        if (same_connection(open.options, options))
            if (auto line = open.line.lock()) return line;
    auto own = options;
    own.client_id += own.client_id.empty() ? "" : "-stops";
    own.will.reset();
    auto line = std::make_shared<StopLine>(io_, own);
    open_.push_back({options, line});
    return line;
}

}  // namespace asip::agent
