// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/presence/sim_broker.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace truth::presence {
namespace {

constexpr std::size_t kMaxPublished = 200;

std::string_view first_level(std::string_view& rest) {
    const auto end = rest.find('/');
    const auto level = rest.substr(0, end);
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
    return level;
}

bool matches(std::string_view filter, std::string_view topic) {
    bool more_filter = true;
    bool more_topic = true;
    while (more_filter && more_topic) {
        if (filter == "#") return true;
        more_filter = filter.find('/') != std::string_view::npos;
        more_topic = topic.find('/') != std::string_view::npos;
        const auto wanted = first_level(filter);
        const auto level = first_level(topic);
        if (wanted != "+" && wanted != level) return false;
    }
    return !more_topic && (!more_filter || filter == "#");
}

/// What stands in front of the first wildcard.
std::string literal(const std::string& filter) {
    return filter.substr(0, filter.find_first_of("+#"));
}

bool is_announcement(const std::string& topic) {
    return topic.ends_with("/$state") || topic.ends_with("/$description");
}

}  // namespace

SimBroker::Client SimBroker::connect(Receive receive, std::optional<Message> will) {
    sessions_[++last_client_] = {std::move(receive), std::move(will), {}, {}, {}, {}};
    return last_client_;
}

void SimBroker::subscribe(Client client, const std::string& filter, bool no_local, bool retained, Time now) {
    const auto found = sessions_.find(client);
    if (found == sessions_.end()) return;
    unsubscribe(client, filter);
    const auto begin = literal(filter);
    found->second.filters.push_back(filter);
    subscriptions_[begin].push_back({client, filter, no_local});
    if (!retained) return;
    // "a/#" is "a", too.
    const auto from = begin.ends_with('/') ? begin.substr(0, begin.size() - 1) : begin;
    for (auto at = stored_.lower_bound(from); at != stored_.end() && at->first.starts_with(from); ++at) {
        if (!matches(filter, at->first)) continue;
        if (auto message = left_of(at->second, now)) {
            message->retain = true;
            send(client, found->second, std::make_shared<const Message>(std::move(*message)), {}, now);
        }
    }
}

void SimBroker::unsubscribe(Client client, const std::string& filter) {
    const auto found = sessions_.find(client);
    if (found == sessions_.end() || std::erase(found->second.filters, filter) == 0) return;
    forget(client, filter);
}

void SimBroker::forget(Client client, const std::string& filter) {
    const auto found = subscriptions_.find(literal(filter));
    std::erase_if(found->second,
                  [&](const auto& one) { return one.client == client && one.filter == filter; });
    if (found->second.empty()) subscriptions_.erase(found);
}

/// In the order in which they connected.
std::vector<SimBroker::Client> SimBroker::receivers(const std::string& topic, Client from) const {
    std::vector<Client> found;
    const auto add = [&](const std::string& begin) {
        const auto those = subscriptions_.find(begin);
        if (those == subscriptions_.end()) return;
        for (const auto& one : those->second)
            if (!(one.no_local && one.client == from) && matches(one.filter, topic))
                found.push_back(one.client);
    };
    add("");
    for (auto slash = topic.find('/'); slash != std::string::npos; slash = topic.find('/', slash + 1))
        add(topic.substr(0, slash + 1));
    add(topic);
    add(topic + "/");
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

std::optional<Message> SimBroker::left_of(const Stored& stored, Time now) const {
    Message message = stored.message;
    if (message.expiry_seconds) {
        const auto age = std::chrono::duration_cast<std::chrono::seconds>(now - stored.at).count();
        if (age >= static_cast<std::int64_t>(*message.expiry_seconds)) return std::nullopt;
        *message.expiry_seconds -= static_cast<std::uint32_t>(age);
    }
    return message;
}

void SimBroker::publish(Client from, Message message, Time now) {
    if (sessions_.contains(from)) publish(From{from, false}, std::move(message), now);
}

void SimBroker::publish(From from, Message message, Time now) {
    if (message.retain && message.payload.empty()) stored_.erase(message.topic);
    if (message.retain && !message.payload.empty()) stored_[message.topic] = {message, now};
    message.retain = false;
    if (is_announcement(message.topic)) {
        published_.emplace_back(now, message);
        if (published_.size() > kMaxPublished) published_.pop_front();
    }
    const auto shared = std::make_shared<const Message>(std::move(message));
    for (const auto client : receivers(shared->topic, from.client))
        send(client, sessions_.at(client), shared, from, now);
}

void SimBroker::send(Client client, Session& session, std::shared_ptr<const Message> message, From from,
                     Time now) {
    const auto longest = in_order_ ? 20 : 400;
    Time& last = in_order_ ? session.last : session.last_of_topic[message->topic];
    last = std::max(last, now + std::chrono::milliseconds(dice_.between(1, longest)));
    if (!in_order_ && from.client != 0) {
        Time& before = session.last_from[from.client];
        if (from.will) last = std::max(last, before);
        before = std::max(before, last);
    }
    under_way_.push({last, ++number_, client, std::move(message)});
}

void SimBroker::replay(Client to, const Message& message, Time now) {
    if (const auto found = sessions_.find(to); found != sessions_.end())
        send(to, found->second, std::make_shared<const Message>(message), {}, now);
}

void SimBroker::end(Client client, bool will, Time now) {
    const auto found = sessions_.find(client);
    if (found == sessions_.end()) return;
    auto last_words = std::exchange(found->second.will, std::nullopt);
    if (will && last_words) publish(From{client, true}, std::move(*last_words), now);
    for (const auto& filter : found->second.filters)
        forget(client, filter);
    sessions_.erase(found);
}

std::optional<Time> SimBroker::next() const {
    return under_way_.empty() ? std::nullopt : std::optional(under_way_.top().due);
}

void SimBroker::deliver_until(Time now) {
    while (!under_way_.empty() && under_way_.top().due <= now) {
        const Delivery delivery = under_way_.top();
        under_way_.pop();
        const auto found = sessions_.find(delivery.client);
        if (found == sessions_.end()) continue;
        const auto receive = found->second.receive;  // it may end its own connection
        if (watch) watch(delivery.client, *delivery.message, delivery.due);
        receive(*delivery.message, delivery.due);
    }
}

}  // namespace truth::presence
